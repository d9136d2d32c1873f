"""`python -m lumel` is the command `lumel`."""

from lumel.cli import main

if __name__ == "__main__":
    main()
