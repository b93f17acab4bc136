"""Which rbdyn is this?"""

import rbdyn

print(f"rbdyn {rbdyn.__version__}")
