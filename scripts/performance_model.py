"""What a run costs as a function of unknowns and ranks: fitted to summaries of runs, evaluated beyond them.

Symbols: N unknowns, P ranks, n = N / P. Work is measured; the network is described by three assumed constants. Contact
problems in 3D with multigrid, all bodies divided evenly among the ranks.
"""

from dataclasses import dataclass, field

import numpy as np

# Parts of the cost and what they grow with. `work`: in unknown-operations of a run of `counts` on one rank.
VOLUME, SURFACE = "volume", "surface"


@dataclass(frozen=True)
class Counts:
    """How often a run does what: of a whole run, or of one increment."""
    newton: float
    linear: float
    set_ups: float
    increments: float


@dataclass(frozen=True)
class Network:
    """Assumed, not measured: what is usual between nodes of a cluster, a rank a core."""
    latency: float = 2e-6        # seconds a message
    bandwidth: float = 0.3e9     # bytes a second for each rank when all send at once: 12.5 GB/s a node of 40 ranks
    hop: float = 1.5e-6          # seconds a stage of a reduction; log2(P) stages there and as many back


@dataclass(frozen=True)
class Multigrid:
    """GAMG with 2 + 2 steps of Chebyshev's iteration a level."""
    products: int = 7            # of a level's matrix in one iteration of GMRES: 4 + 1 smoothing, 1 residual, 1 Krylov
    coarsening: float = 20.0     # unknowns of a level to those of the next one
    coarsest: float = 50.0       # unknowns of the last one
    neighbours: int = 26         # ranks that a rank shares nodes with
    reductions: int = 3          # in one iteration of GMRES with classical Gram-Schmidt, the norm included
    set_up_messages: int = 60    # rounds of messages a level in a set-up: graph, aggregates, prolongator, products


def parts_of(unknowns, counts):
    """name -> (work on one rank, how it is divided). Contact lives on surfaces: N^(2/3) points, on P^(2/3) ranks."""
    surface = unknowns ** (2 / 3)
    return {
        "start": (unknowns, VOLUME),
        "set-ups": (unknowns * counts.set_ups, VOLUME),
        "iterations": (unknowns * counts.linear, VOLUME),
        "bulk": (unknowns * counts.newton, VOLUME),
        "search and contact": (surface * counts.newton, SURFACE),
        "certificate and output": (unknowns * counts.increments, VOLUME),
    }


PHASES = {"start": ("mesh", "set up", "pattern", "rest"), "bulk": ("bulk", "matrix", "loads", "support"),
          "search and contact": ("search", "contact"),
          "certificate and output": ("certificate", "output", "error estimate")}


@dataclass
class Fit:
    """CPU seconds per unit of work of each part, and how far the fitted runs are from it."""
    seconds: dict
    misfits: list = field(default_factory=list)  # predicted / measured CPU seconds of each run


def measured(summary):
    """(unknowns, Counts, CPU seconds of each group of PHASES and of 'solver') of a run. Waiting for a busy machine
    lengthens all phases alike, so CPU time is shared out as wall time is."""
    resources = summary["resources"]
    phases = resources["phase_seconds"]
    scale = resources["cpu_seconds"] / sum(phases.values())
    groups = {name: scale * sum(phases.get(phase, 0.0) for phase in members) for name, members in PHASES.items()}
    groups["solver"] = scale * (phases.get("linear solver", 0.0) + phases.get("factorization", 0.0))
    counts = Counts(summary["newton_iterations"], summary["linear_iterations"], summary["factorizations"],
                    summary["increments"])
    return sum(summary["scene"]["unknowns"].values()), counts, groups


def fit(summaries):
    """Least relative squares; the solver's time is shared between set-ups and iterations. Errors: ValueError with fewer
    than two runs."""
    if len(summaries) < 2:
        raise ValueError("a model needs at least two runs")
    runs = [measured(summary) for summary in summaries]
    seconds = {}
    for name in PHASES:
        rates = [groups[name] / parts_of(unknowns, counts)[name][0] for unknowns, counts, groups in runs]
        seconds[name] = float(np.mean(rates))
    matrix = np.array([[parts_of(unknowns, counts)[name][0] / groups["solver"] for name in ("set-ups", "iterations")]
                       for unknowns, counts, groups in runs])
    solution = np.linalg.lstsq(matrix, np.ones(len(runs)), rcond=None)[0]
    if solution.min() < 0.0:  # runs that differ too little to tell the two apart
        solution = np.array([0.0, 1.0]) / np.mean(matrix[:, 1])
    seconds["set-ups"], seconds["iterations"] = map(float, solution)
    result = Fit(seconds)
    for unknowns, counts, groups in runs:
        predicted = sum(seconds[name] * work for name, (work, _) in parts_of(unknowns, counts).items())
        result.misfits.append(predicted / sum(groups.values()))
    return result


def levels_of(unknowns, grid):
    sizes = [unknowns]
    while sizes[-1] > grid.coarsest * grid.coarsening:
        sizes.append(sizes[-1] / grid.coarsening)
    return sizes


def halo_seconds(unknowns, ranks, network, grid):
    """One exchange of a vector's values between neighbours: a layer of nodes on six faces of a cube, 8 bytes each."""
    owned = max(unknowns / ranks, 1.0)
    stages = min(grid.neighbours, ranks - 1)
    surface = 6 * 3 ** (1 / 3) * owned ** (2 / 3)
    return stages * network.latency + 8 * surface / network.bandwidth


def communication(unknowns, ranks, counts, network=Network(), grid=Multigrid()):
    """name -> wall seconds that P ranks spend on messages; nothing for one rank. The coarser levels are kept on all
    ranks: their exchanges cost latency however small they are."""
    if ranks == 1:
        return {"halo": 0.0, "reductions": 0.0, "coarse grids": 0.0, "search exchange": 0.0}
    reduction = 2 * np.log2(ranks) * network.hop
    sizes = levels_of(unknowns, grid)
    finest, *coarse = [halo_seconds(size, ranks, network, grid) for size in sizes]
    surface = 8 * 3 * (unknowns / ranks) ** (2 / 3)  # places of a rank's contact facets, three doubles each
    set_ups = counts.set_ups * grid.set_up_messages
    return {
        "halo": (grid.products * counts.linear + set_ups + 2 * counts.newton) * finest,
        "reductions": (grid.reductions * counts.linear + 10 * counts.newton) * reduction,
        "coarse grids": (grid.products * counts.linear + set_ups) * sum(coarse) + 2 * counts.linear * reduction,
        "search exchange": counts.newton * (grid.neighbours * network.latency + surface / network.bandwidth),
    }


def wall_seconds(result, unknowns, ranks, counts, network=Network(), grid=Multigrid()):
    """name -> wall seconds on as many free cores as ranks."""
    shares = {VOLUME: ranks, SURFACE: max(1.0, ranks ** (2 / 3))}
    work = {name: result.seconds[name] * size / shares[kind]
            for name, (size, kind) in parts_of(unknowns, counts).items()}
    return {**work, **communication(unknowns, ranks, counts, network, grid)}
