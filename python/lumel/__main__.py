"""`python -m lumel` is the command `lumel`."""

import sys

from lumel.cli import main

if __name__ == "__main__":
    sys.exit(main())
