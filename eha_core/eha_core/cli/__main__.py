"""`python -m eha_core.cli` is `eha`."""

import sys

from eha_core.cli import main

sys.exit(main())
