"""Reference values for the 78-parameter model, from the LaTeX text of equations (4)-(9) of the paper.

The LaTeX below is the printed text. It is parsed into Python expressions and evaluated, so nothing of the Rust code is
repeated here. Run: python tests/reference/paper78.py > tests/reference/paper78.json
"""

import json
import re

import numpy as np

G = 9.81
PRINTED = [
    r"""\ddot{\theta}_1(X_1 + X_2 + X_3 + X_4 + X_5 + X_6) + \ddot{\theta}_2(X_7 + \cos(\theta_1 - \theta_2)(X_8 + X_9 + X_{10} + X_{11}) + X_{12})
    + \ddot{\theta}_3(X_{13} + \cos(\theta_1 - \theta_3)(X_{14} + X_{15} + X_{16} + X_{17})) + \ddot{\theta}_4(X_{18} + \cos(\theta_1 - \theta_4)(X_{19} + X_{20} + X_{21}))
    + \ddot{\theta}_5(X_{22} + \cos(\theta_1 - \theta_5)(X_{23} + X_{24})) + \ddot{\theta}_6(X_{25} + \cos(\theta_1 - \theta_6)X_{26})
    + \sin(\theta_1 - \theta_2)(\dot{\theta}_2^2 - \dot{\theta}_1\dot{\theta}_2)(X_{12} + X_{11} + X_{10} + X_9 + X_8)
    + \sin(\theta_1 - \theta_3)(\dot{\theta}_3^2 - \dot{\theta}_1\dot{\theta}_3)(X_{17} + X_{16} + X_{15} + X_{14})
    + \sin(\theta_1 - \theta_4)(\dot{\theta}_4^2 - \dot{\theta}_1\dot{\theta}_4)(X_{21} + X_{20} + X_{19}) + \sin(\theta_1 - \theta_5)(\dot{\theta}_5^2 - \dot{\theta}_1\dot{\theta}_5)(X_{24} + X_{23})
    + \sin(\theta_1 - \theta_6)(\dot{\theta}_6^2 - \dot{\theta}_1\dot{\theta}_6)X_{26} + g \cos(\theta_1)X_{27} + \text{sgn}(\dot{\theta}_1)X_{28} + \dot{\theta}_1X_{29}""",
    r"""\ddot{\theta}_1(X_7 + \cos(\theta_1 - \theta_2)(X_8 + X_9 + X_{10} + X_{11} + X_{12})) + \ddot{\theta}_2(X_7 + X_{30} + X_{31} + X_{32} + X_{33} + X_{34})
    + \ddot{\theta}_3(X_{13} + \cos(\theta_2 - \theta_3)(X_{35} + X_{36} + X_{37} + X_{38})) + \ddot{\theta}_4(X_{18} + \cos(\theta_2 - \theta_4)(X_{39} + X_{40} + X_{41}))
    + \ddot{\theta}_5(X_{22} + \cos(\theta_2 - \theta_5)(X_{42} + X_{43})) + \ddot{\theta}_6(X_{25} + \cos(\theta_2 - \theta_6)X_{44})
    + \sin(\theta_1 - \theta_2)(\dot{\theta}_2^2 - \dot{\theta}_1\dot{\theta}_2)(X_{12} + X_{11} + X_{10} + X_9 + X_8)
    + \sin(\theta_2 - \theta_3)(\dot{\theta}_3^2 - \dot{\theta}_2\dot{\theta}_3)(X_{37} + X_{36} + X_{35}) + \sin(\theta_2 - \theta_4)(\dot{\theta}_4^2 - \dot{\theta}_2\dot{\theta}_4)(X_{41} + X_{40} + X_{39})
    + \sin(\theta_2 - \theta_5)(\dot{\theta}_5^2 - \dot{\theta}_2\dot{\theta}_5)(X_{43} + X_{42}) + \sin(\theta_2 - \theta_6)(\dot{\theta}_6^2 - \dot{\theta}_2\dot{\theta}_6)X_{44}
    + g \cos \theta_2 X_{45} + \text{sgn}(\dot{\theta}_2)X_{46} + \dot{\theta}_2X_{47}""",
    r"""\ddot{\theta}_1(X_{18} + \cos(\theta_1 - \theta_3)(X_{14} + X_{15} + X_{16} + X_{17}))
    + \ddot{\theta}_2(X_{18} + \cos(\theta_2 - \theta_3)(X_{35} + X_{36} + X_{37} + X_{38}))
    + \ddot{\theta}_3(X_{18} + X_{48} + X_{49} + X_{50} + X_{51}) + \ddot{\theta}_4(X_{18} + \cos(\theta_3 - \theta_4)(X_{52} + X_{53} + X_{54}))
    + \ddot{\theta}_5(X_{22} + \cos(\theta_3 - \theta_5)(X_{55} + X_{56})) + \ddot{\theta}_6(X_{25} + \cos(\theta_3 - \theta_6)X_{57})
    + \sin(\theta_1 - \theta_3)(\dot{\theta}_1\dot{\theta}_3 - \dot{\theta}_1^2)(X_{17} + X_{16} + X_{15} + X_{14})
    + \sin(\theta_2 - \theta_3)(\dot{\theta}_2\dot{\theta}_3 - \dot{\theta}_2^2)(X_{38} + X_{37} + X_{36} + X_{35})
    + \sin(\theta_3 - \theta_4)(\dot{\theta}_4^2 - \dot{\theta}_3\dot{\theta}_4)(X_{54} + X_{53} + X_{52}) + \sin(\theta_3 - \theta_5)(\dot{\theta}_5^2 - \dot{\theta}_3\dot{\theta}_5)(X_{56} + X_{55})
    + \sin(\theta_3 - \theta_6)(\dot{\theta}_6^2 - \dot{\theta}_3\dot{\theta}_6)X_{57} + g \cos \theta_3 X_{58} + \operatorname{sgn}(\dot{\theta}_3)X_{59} + \dot{\theta}_3 X_{60}""",
    r"""\ddot{\theta}_1(X_{18} + \cos(\theta_1 - \theta_4)(X_{19} + X_{20} + X_{21})) + \ddot{\theta}_2(X_{18} + \cos(\theta_2 - \theta_4)(X_{39} + X_{40} + X_{41}))
    + \ddot{\theta}_3(X_{18} + \cos(\theta_3 - \theta_4)(X_{52} + X_{53} + X_{54})) + \ddot{\theta}_4(X_{18} + X_{61} + X_{62} + X_{63})
    + \ddot{\theta}_5(X_{22} + \cos(\theta_4 - \theta_5)(X_{64} + X_{65})) + \ddot{\theta}_6(X_{25} + \cos(\theta_4 - \theta_6)X_{66})
    + \sin(\theta_1 - \theta_4)(\dot{\theta}_1\dot{\theta}_4 - \dot{\theta}_1^2)(X_{21} + X_{20} + X_{19}) + \sin(\theta_2 - \theta_4)(\dot{\theta}_2\dot{\theta}_4 - \dot{\theta}_2^2)(X_{41} + X_{40} + X_{39})
    + \sin(\theta_3 - \theta_4)(\dot{\theta}_3\dot{\theta}_4 - \dot{\theta}_3^2)(X_{54} + X_{53} + X_{52}) + \sin(\theta_4 - \theta_5)(\dot{\theta}_4\dot{\theta}_5 + \dot{\theta}_5^2)(X_{65} + X_{64})
    + \sin(\theta_4 - \theta_6)(\dot{\theta}_6^2 - \dot{\theta}_4\dot{\theta}_6)X_{66} + g \cos \theta_4 X_{67} + \operatorname{sgn}(\dot{\theta}_4)X_{68} + \dot{\theta}_4 X_{69}""",
    r"""\ddot{\theta}_1(X_{22} + \cos(\theta_1 - \theta_5)(X_{23} + X_{24})) + \ddot{\theta}_2(X_{22} + \cos(\theta_2 - \theta_5)(X_{42} + X_{43}))
    + \ddot{\theta}_3(X_{22} + \cos(\theta_3 - \theta_5)(X_{56} + X_{57})) + \ddot{\theta}_4(X_{22} + \cos(\theta_4 - \theta_5)(X_{64} + X_{65}))
    + \ddot{\theta}_5(X_{22} + X_{70}) + \ddot{\theta}_6(X_{25} + m_6 \cos(\theta_5 - \theta_6)X_{71})
    + \sin(\theta_1 - \theta_5)(\dot{\theta}_1\dot{\theta}_5 - \dot{\theta}_1^2)(X_{24} + X_{23})
    + \sin(\theta_2 - \theta_5)(\dot{\theta}_2\dot{\theta}_5 - \dot{\theta}_2^2)(X_{42} + X_{43})
    + \sin(\theta_3 - \theta_5)(\dot{\theta}_3\dot{\theta}_5 - \dot{\theta}_3^2)(X_{57} + X_{56})
    + \sin(\theta_4 - \theta_5)(\dot{\theta}_4\dot{\theta}_5 - \dot{\theta}_4^2)(X_{66} + X_{64})
    + \sin(\theta_5 - \theta_6)(\dot{\theta}_6^2 - \dot{\theta}_5\dot{\theta}_6)X_{71}
    + g \cos \theta_5 X_{72} + \operatorname{sgn}(\dot{\theta}_5)X_{73} + (\dot{\theta}_5)X_{74}""",
    r"""\ddot{\theta}_1(X_{25} + \cos(\theta_1 - \theta_6)X_{26}) + \ddot{\theta}_2(X_{25} + \cos(\theta_2 - \theta_6)X_{44}) + \ddot{\theta}_3(X_{25} + \cos(\theta_3 - \theta_6)X_{58})
    + \ddot{\theta}_4(X_{25} + \cos(\theta_4 - \theta_6)X_{66}) + \ddot{\theta}_5(X_{25} + m_6 \cos(\theta_5 - \theta_6)X_{71}) + \ddot{\theta}_6(X_{25} + X_{75})
    + \sin(\theta_1 - \theta_6)(\dot{\theta}_1\dot{\theta}_6 - \dot{\theta}_1^2)X_{26} + \sin(\theta_2 - \theta_6)(\dot{\theta}_2\dot{\theta}_6 - \dot{\theta}_2^2)X_{44}
    + \sin(\theta_3 - \theta_6)(\dot{\theta}_3\dot{\theta}_6 - \dot{\theta}_3^2)X_{58} + \sin(\theta_4 - \theta_6)(\dot{\theta}_4\dot{\theta}_6 - \dot{\theta}_4^2)X_{66}
    + \sin(\theta_5 - \theta_6)(\dot{\theta}_5\dot{\theta}_6 - \dot{\theta}_5^2)X_{71} + g \cos \theta_6 X_{76} + \operatorname{sgn}(\dot{\theta}_6)X_{77} + (\dot{\theta}_6)X_{78}""",
]

# (equation, printed, corrected); each printed text must occur exactly once.
CORRECTIONS = [
    (4, r"(X_8 + X_9 + X_{10} + X_{11}) + X_{12})", r"(X_8 + X_9 + X_{10} + X_{11} + X_{12}))"),
    (5, r"\sin(\theta_1 - \theta_2)(\dot{\theta}_2^2 - \dot{\theta}_1\dot{\theta}_2)", r"\sin(\theta_1 - \theta_2)(\dot{\theta}_1\dot{\theta}_2 - \dot{\theta}_1^2)"),
    (5, r"(X_{37} + X_{36} + X_{35})", r"(X_{38} + X_{37} + X_{36} + X_{35})"),
    (6, r"\ddot{\theta}_1(X_{18}", r"\ddot{\theta}_1(X_{13}"),
    (6, r"\ddot{\theta}_2(X_{18}", r"\ddot{\theta}_2(X_{13}"),
    (6, r"\ddot{\theta}_3(X_{18}", r"\ddot{\theta}_3(X_{13}"),
    (7, r"(\dot{\theta}_4\dot{\theta}_5 + \dot{\theta}_5^2)", r"(\dot{\theta}_5^2 - \dot{\theta}_4\dot{\theta}_5)"),
    (8, r"(X_{56} + X_{57})", r"(X_{55} + X_{56})"),
    (8, r"(X_{57} + X_{56})", r"(X_{56} + X_{55})"),
    (8, r"(X_{66} + X_{64})", r"(X_{65} + X_{64})"),
    (9, r"\cos(\theta_3 - \theta_6)X_{58}", r"\cos(\theta_3 - \theta_6)X_{57}"),
    (9, r"(\dot{\theta}_3\dot{\theta}_6 - \dot{\theta}_3^2)X_{58}", r"(\dot{\theta}_3\dot{\theta}_6 - \dot{\theta}_3^2)X_{57}"),
]


def compiled(latex):
    """A Python expression from the LaTeX, with implied products and brackets written out."""
    text = re.sub(r"[{}]|\\(text|operatorname)", "", latex)
    text = re.sub(r"\\ddot\\theta_(\d)", r" dd[\1] ", text)
    text = re.sub(r"\\dot\\theta_(\d)\^2", r" d[\1]**2 ", text)
    text = re.sub(r"\\dot\\theta_(\d)", r" d[\1] ", text)
    text = re.sub(r"\\(cos|sin)\s*\\theta_(\d)", r" \1(t[\2]) ", text)
    text = re.sub(r"\\theta_(\d)", r" t[\1] ", text)
    text = re.sub(r"X_(\d+)", r" X[\1] ", text)
    text = text.replace("m_6", "").replace("\\", " ")
    tokens = re.findall(r"[a-zA-Z]+\[\d+\](?:\*\*2)?|cos|sin|sgn|g|[()+-]", text)
    assert "".join(tokens) == re.sub(r"\s", "", text), "text that no token covers"
    out = []
    for token in tokens:
        value_before = out and out[-1] not in ("(", "+", "-", "cos", "sin", "sgn")
        if value_before and token not in (")", "+", "-"):
            out.append("*")
        out.append(token)
    return compile("".join(out), "equation", "eval")


def regressor(equations, t, d, dd):
    """6 x 78, by giving each X in turn the value 1."""
    y = np.zeros((6, 78), dtype=np.result_type(t, d, dd))
    one_based = lambda v: np.concatenate([[np.nan], v])
    names = {"t": one_based(t), "d": one_based(d), "dd": one_based(dd), "g": G, "cos": np.cos, "sin": np.sin}
    names["sgn"] = lambda v: np.sign(v.real)
    for k in range(78):
        x = np.zeros(79)
        x[k + 1] = 1.0
        y[:, k] = [eval(e, {**names, "X": x}) for e in equations]
    return y


def mass_columns(equations, t):
    """M[i, j, k]: coefficient of X_(k+1) in entry (i, j) of the mass matrix."""
    zero = np.zeros(6)
    rest = regressor(equations, t, zero, zero)
    return np.stack([regressor(equations, t, zero, unit) - rest for unit in np.eye(6)], axis=1)


def euler_lagrange(equations, t, d, dd):
    """Velocity terms from the mass matrix: sum_jk (dM_ij/dt_k - dM_jk/dt_i / 2) d_j d_k, by complex steps."""
    zero = np.zeros(6)
    step = 1e-30
    slope = np.stack([mass_columns(equations, t + 1j * step * unit).imag / step for unit in np.eye(6)])
    velocity = np.einsum("kijp,j,k->ip", slope, d, d) - 0.5 * np.einsum("ijkp,j,k->ip", slope, d, d)
    friction = regressor(equations, zero, d, zero) - regressor(equations, zero, zero, zero)
    keep = np.zeros(78)
    keep[[28 - 1, 29 - 1, 46 - 1, 47 - 1, 59 - 1, 60 - 1, 68 - 1, 69 - 1, 73 - 1, 74 - 1, 77 - 1, 78 - 1]] = 1.0
    return regressor(equations, t, zero, dd) + velocity + friction * keep


def structure(evaluate):
    random = np.random.default_rng(7)
    rows = [evaluate(*(random.uniform(-s, s, 6) for s in (np.pi, 3.0, 10.0))) for _ in range(80)]
    y = np.vstack(rows)
    y = y / np.linalg.norm(y, axis=0)
    singular = np.linalg.svd(y, compute_uv=False)
    rank = int((singular > 1e-10 * singular[0]).sum())
    alike = np.abs(y.T @ y) > 1.0 - 1e-10
    groups = []
    for k in range(78):
        group = [int(j) + 1 for j in np.flatnonzero(alike[k])]
        if group[0] == k + 1:
            groups.append(group)
    return {"rank": rank, "gap": [singular[rank - 1] / singular[0], (singular[rank] / singular[0])], "groups": groups}


def main():
    corrected = list(PRINTED)
    for equation, printed, used in CORRECTIONS:
        assert corrected[equation - 4].count(printed) == 1, (equation, printed)
        corrected[equation - 4] = corrected[equation - 4].replace(printed, used)
    printed, corrected = ([compiled(e) for e in text] for text in (PRINTED, corrected))
    variants = {
        "as_printed": lambda *s: regressor(printed, *s),
        "consistent": lambda *s: regressor(corrected, *s),
        "euler_lagrange": lambda *s: euler_lagrange(corrected, *s),
    }
    state = [
        np.array([0.3, -0.8, 1.1, 2.0, -1.7, 0.6]),
        np.array([0.5, -1.2, 0.7, 1.9, -0.4, 2.3]),
        np.array([-2.0, 3.1, 0.9, -4.2, 5.5, 1.3]),
    ]
    out = {"state": [list(v) for v in state]}
    for name, evaluate in variants.items():
        y = evaluate(*state)
        entries = [[int(i) + 1, int(k) + 1, y[i, k]] for i, k in np.argwhere(y != 0.0)]
        out[name] = {"entries": entries, **structure(evaluate)}
    m = mass_columns(printed, state[0])
    skew = np.abs(m - m.transpose(1, 0, 2)).max(axis=2) > 1e-12
    out["asymmetric_as_printed"] = [[int(i) + 1, int(j) + 1] for i, j in np.argwhere(skew) if i < j]
    m = mass_columns(corrected, state[0])
    assert np.abs(m - m.transpose(1, 0, 2)).max() < 1e-15
    print(json.dumps(out, indent=None, separators=(", ", ": ")).replace('], "', '],\n"').replace('}, "', '},\n"'))


main()
