"""`python -m devseg` is the command line."""

import sys

from devseg.cli import main

if __name__ == "__main__":
    sys.exit(main())
