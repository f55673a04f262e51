"""The command ``tauscope``, also as ``python -m tauscope``."""

import signal
import sys

from . import _tauscope


def main() -> None:
    # The command itself hears ctrl-C, or is ended by it as any program is.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if hasattr(signal, "SIGPIPE"):
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    sys.stdout.flush()
    sys.exit(_tauscope.main(["tauscope", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
