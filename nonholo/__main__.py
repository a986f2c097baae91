"""The command `nonholo` as `python -m nonholo`."""

from nonholo.cli import main

if __name__ == "__main__":
    main()
