"""Start the game; ``run_game.py --help`` lists what else it does."""

import os

# One body's matrices are far too small to share among threads; a second BLAS thread only gets in the way.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from game.app.cli import main

if __name__ == "__main__":
    raise SystemExit(main())
