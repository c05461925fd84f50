"""How the pictures of a run look: colours, and matplotlib's settings for a page without a screen."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

INK, FAINT, BLUE, ORANGE = "#22272e", "#b4bcc6", "#1f5fa8", "#d9722c"
STRESS_MAP, PRESSURE_MAP = "viridis", "OrRd"
MAX_LINED_CELLS = 40000  # beyond this many cells mesh lines would hide the colours

plt.rcParams.update({
    "figure.dpi": 110, "savefig.dpi": 170, "font.size": 9.5, "axes.titlesize": 10.5, "axes.titleweight": "regular",
    "axes.edgecolor": INK, "axes.labelcolor": INK, "text.color": INK, "xtick.color": INK, "ytick.color": INK,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.color": "#e6e9ee",
    "grid.linewidth": 0.7, "axes.axisbelow": True, "legend.frameon": False, "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": True,
})
