"""python -m rbdyn: the command line."""

import sys

from rbdyn.command_line import main

sys.exit(main())
