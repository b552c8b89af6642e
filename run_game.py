"""Start the game; ``run_game.py --help`` lists what else it does."""

from game.app.cli import main

if __name__ == "__main__":
    raise SystemExit(main())
