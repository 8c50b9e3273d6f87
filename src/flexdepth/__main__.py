"""`python -m flexdepth`: the command line without the `flexdepth` script."""

import sys

from flexdepth.cli.main import main

sys.exit(main())
