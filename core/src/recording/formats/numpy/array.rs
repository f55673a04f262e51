//! An array of numpy in its own format, `.npy`.

/// An array as it stands in a file.
pub(super) struct Array {
    pub name: String,
    pub shape: Vec<usize>,
    pub values: Vec<f64>,
    pub texts: Vec<String>,
}

/// The arrays in a `.npy`: one, or one per named field.
pub(super) fn fields(bytes: &[u8], name: &str) -> std::result::Result<Vec<Array>, String> {
    let broken = || "the array is damaged or cut off; save it again".to_owned();
    if bytes.get(..6) != Some(b"\x93NUMPY") {
        return Err("this is no array of numpy".to_owned());
    }
    let long = *bytes.get(6).ok_or_else(broken)? > 1;
    let length = match long {
        true => bytes.get(8..12).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize),
        false => bytes.get(8..10).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]]))),
    };
    let start = if long { 12 } else { 10 };
    let length = length.ok_or_else(broken)?;
    let header = bytes.get(start..start + length).ok_or_else(broken)?;
    let data = &bytes[start + length..];
    let header = String::from_utf8_lossy(header).into_owned();
    let entry = |key: &str| header.split_once(&format!("'{key}':")).map(|(_, rest)| rest.trim_start());
    let shape: Vec<usize> = entry("shape")
        .and_then(|rest| rest.strip_prefix('(')?.split_once(')'))
        .map(|(inside, _)| inside.split(',').filter_map(|part| part.trim().parse().ok()).collect())
        .ok_or_else(broken)?;
    let columns_first = entry("fortran_order").is_some_and(|rest| rest.starts_with("True"));
    let descr = entry("descr").ok_or_else(broken)?;
    let count: usize = shape.iter().try_fold(1usize, |product, size| product.checked_mul(*size)).ok_or_else(broken)?;
    let parts: Vec<(String, Kind, usize)> = match descr.strip_prefix('[') {
        Some(list) => named_parts(list).ok_or_else(|| format!("its fields {descr} are not read"))?,
        None => {
            let code = descr.trim_start_matches('\'').split('\'').next().unwrap_or_default();
            vec![(name.to_owned(), Kind::parse(code).ok_or_else(|| format!("numbers of type {code} are not read"))?, 1)]
        }
    };
    let size: usize = parts.iter().map(|(_, kind, times)| kind.bytes * times).sum();
    if data.len() < count.saturating_mul(size) || size == 0 {
        return Err(broken());
    }
    let mut out = Vec::new();
    let mut offset = 0;
    for (name, kind, times) in parts {
        let item = |index: usize, time: usize| {
            let start = index * size + offset + time * kind.bytes;
            &data[start..start + kind.bytes]
        };
        let all = || (0..count).flat_map(|index| (0..times).map(move |time| (index, time)));
        let mut shape = shape.clone();
        let (mut values, mut texts) = (Vec::new(), Vec::new());
        match kind.letter {
            'U' => texts = all().map(|(index, time)| kind.text(item(index, time))).collect(),
            _ => values = all().map(|(index, time)| kind.number(item(index, time))).collect(),
        }
        if columns_first && shape.len() == 2 {
            shape.reverse();
        }
        if times > 1 {
            shape.push(times);
        }
        // A field of a single row or column is a vector.
        if shape.len() == 2 && shape.contains(&1) {
            shape = vec![values.len().max(texts.len())];
        }
        out.push(Array { name, shape, values, texts });
        offset += kind.bytes * times;
    }
    Ok(out)
}

/// `('t', '<f8'), ('q', '<f8', (6,))]`: names, types and how many there are of each.
fn named_parts(list: &str) -> Option<Vec<(String, Kind, usize)>> {
    let mut out = Vec::new();
    let mut rest = list;
    while let Some((_, behind)) = rest.split_once("('") {
        let (name, behind) = behind.split_once('\'')?;
        let (_, behind) = behind.split_once('\'')?;
        let (code, behind) = behind.split_once('\'')?;
        let (times, behind) = match behind.trim_start().strip_prefix(',').map(str::trim_start) {
            Some(tuple) if tuple.starts_with('(') => {
                let (inside, behind) = tuple[1..].split_once(')')?;
                let sizes: Option<Vec<usize>> = inside
                    .split(',')
                    .map(str::trim)
                    .filter(|part| !part.is_empty())
                    .map(|part| part.parse().ok())
                    .collect();
                (sizes?.into_iter().product(), behind)
            }
            _ => (1, behind),
        };
        out.push((name.to_owned(), Kind::parse(code)?, times));
        rest = behind;
    }
    (!out.is_empty()).then_some(out)
}

/// Type of an array's items.
#[derive(Clone, Copy)]
struct Kind {
    letter: char,
    bytes: usize,
    big: bool,
}

impl Kind {
    fn parse(code: &str) -> Option<Kind> {
        let big = code.starts_with('>');
        let bare = code.trim_start_matches(['<', '>', '|', '=']);
        let letter = bare.chars().next()?;
        let size: usize = bare.get(1..)?.trim_end_matches(|letter: char| !letter.is_ascii_digit()).parse().ok()?;
        let bytes = if letter == 'U' { 4 * size } else { size };
        let known = match letter {
            'f' => matches!(size, 2 | 4 | 8),
            'i' | 'u' => matches!(size, 1 | 2 | 4 | 8),
            'b' => size == 1,
            'U' => size > 0,
            _ => false,
        };
        known.then_some(Kind { letter, bytes, big })
    }

    fn number(self, bytes: &[u8]) -> f64 {
        let mut word = [0u8; 8];
        for (place, &byte) in bytes.iter().enumerate() {
            word[if self.big { bytes.len() - 1 - place } else { place }] = byte;
        }
        let all = u64::from_le_bytes(word);
        let unused = 64 - 8 * bytes.len() as u32;
        match (self.letter, self.bytes) {
            ('f', 8) => f64::from_bits(all),
            ('f', 2) => half(all as u16),
            ('f', _) => f64::from(f32::from_bits(all as u32)),
            ('i', _) => (((all << unused) as i64) >> unused) as f64,
            _ => all as f64,
        }
    }

    fn text(self, bytes: &[u8]) -> String {
        let letter = |word: &[u8]| {
            let word = [word[0], word[1], word[2], word[3]];
            char::from_u32(if self.big { u32::from_be_bytes(word) } else { u32::from_le_bytes(word) })
        };
        bytes.chunks_exact(4).filter_map(letter).filter(|letter| *letter != '\0').collect()
    }
}

/// The value of a number of half precision: a sign, five bits of exponent, ten of fraction.
fn half(bits: u16) -> f64 {
    let (sign, exponent, fraction) = (bits >> 15, (bits >> 10) & 0x1F, f64::from(bits & 0x3FF) / 1024.0);
    let size = match exponent {
        0 => fraction * 2f64.powi(-14),
        0x1F if fraction == 0.0 => f64::INFINITY,
        0x1F => f64::NAN,
        _ => (1.0 + fraction) * 2f64.powi(i32::from(exponent) - 15),
    };
    if sign == 0 { size } else { -size }
}

#[cfg(test)]
mod tests {
    use super::half;

    #[test]
    fn numbers_of_half_precision() {
        let known =
            [(0x3C00, 1.0), (0xC000, -2.0), (0x7BFF, 65504.0), (0x0001, 5.960_464_477_539_063e-8), (0x8000, 0.0)];
        assert!(known.into_iter().all(|(bits, value)| half(bits) == value));
        assert!(half(0x3555) - 1.0 / 3.0 < 1e-4 && half(0x7C00) == f64::INFINITY && half(0x7C01).is_nan());
    }
}
