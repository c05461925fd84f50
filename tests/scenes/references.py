"""Closed forms that the scenes are compared with. Units are the caller's, consistent; pressures are positive.

K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, is cited as [J] with its equation numbers.
"""
import numpy as np


def contact_modulus(*materials):
    """E* of [J] 4.2b from (E, nu) of the elastic bodies; a rigid body is left out."""
    return 1.0 / sum((1.0 - nu**2) / E for E, nu in materials)


def line_contact(force, radius, modulus):
    """Half-width a and peak pressure p0 of cylinders under `force` per length, [J] 4.43 and 4.45."""
    a = np.sqrt(4.0 * force * radius / (np.pi * modulus))
    return a, 2.0 * force / (np.pi * a)


def cattaneo_mindlin(x, a, limit, ratio):
    """Stick half-width c and shear traction of a pressed and then sheared line contact; limit = mu p0, ratio = Q/(mu P).

    K. L. Johnson, Contact Mechanics (1985), 7.2: c/a = sqrt(1 - Q/(mu P)),
    q = mu p0 [sqrt(1 - (x/a)^2) - (c/a) sqrt(1 - (x/c)^2)], the second term for |x| < c.
    """
    c = a * np.sqrt(1.0 - ratio)
    ellipse = lambda r: np.sqrt(np.maximum(0.0, 1.0 - (x / r) ** 2))
    return c, limit * (ellipse(a) - c / a * ellipse(c))


def best_linear(nodes, function, points=20):
    """Values at `nodes` (ascending) of the continuous function, linear between them, that is nearest to `function` in L2,
    and its distance, an integral over all nodes' span."""
    place, weight = np.polynomial.legendre.leggauss(points)
    half = 0.5 * np.diff(nodes)
    at = (0.5 * (nodes[1:] + nodes[:-1]) + half * place[:, None]).T
    weights, values = half[:, None] * weight, function(at)
    shape = np.array([1.0 - place, 1.0 + place]) / 2.0
    matrix, right = np.zeros((len(nodes), len(nodes))), np.zeros(len(nodes))
    first = np.arange(len(half))
    for i in range(2):
        np.add.at(right, first + i, np.sum(weights * shape[i] * values, axis=1))
        for j in range(2):
            np.add.at(matrix, (first + i, first + j), np.sum(weights * shape[i] * shape[j], axis=1))
    best = np.linalg.solve(matrix, right)
    return best, np.sqrt(np.sum(weights * (np.interp(at, nodes, best) - values) ** 2))


def sphere_contact(force, radius, modulus):
    """Contact radius a and peak pressure p0 of spheres under `force`, [J] 4.22 and 4.24."""
    a = np.cbrt(3.0 * force * radius / (4.0 * modulus))
    return a, 3.0 * force / (2.0 * np.pi * a**2)


def mindlin_displacement(force, normal, a, compliance, mu):
    """Tangential displacement of a sphere on a half-space whose tangential force grows to `force`; `compliance` is the
    sum over the elastic bodies of (2 - nu) / G. [J] 7.41 to 7.44 (R. D. Mindlin 1949)."""
    return 3.0 * mu * normal / (16.0 * a) * compliance * (1.0 - (1.0 - force / (mu * normal)) ** (2.0 / 3.0))


def mindlin_loop_energy(amplitude, normal, a, compliance, mu):
    """Work done in a cycle of the tangential force between +- amplitude: R. D. Mindlin and H. Deresiewicz (1953), J. Appl.
    Mech. 20, 327-344; the area between mindlin_displacement's branches after Masing's rule
    delta = delta* - 2 delta((Q* - Q) / 2)."""
    k = amplitude / (mu * normal)
    share = 1.0 - (1.0 - k) ** (5.0 / 3.0) - 5.0 * k / 6.0 * (1.0 + (1.0 - k) ** (2.0 / 3.0))
    return 9.0 * (mu * normal) ** 2 / (10.0 * a) * compliance * share


def hertz_pressure(r, a, p0):
    """p0 sqrt(1 - (r/a)^2) inside the contact, zero outside: line and point contact alike."""
    return p0 * np.sqrt(np.maximum(0.0, 1.0 - (np.asarray(r) / a) ** 2))


def line_contact_profile(x, a, p0, E, nu):
    """Deflection of a half-plane (plane strain, positive outwards, up to a constant) under p0 sqrt(1 - (x/a)^2): slope
    2 (1 - nu^2) p0 / E times x/a inside the contact and x/a - sqrt((x/a)^2 - 1) beyond it ([J] 2.25 integrated)."""
    s = np.abs(np.asarray(x)) / a
    beyond = np.maximum(s, 1.0)
    root = np.sqrt(beyond**2 - 1.0)
    return (1.0 - nu**2) * p0 / E * a * (s**2 - beyond * root + np.log(beyond + root))


def sphere_axis_strain(z, a, p0, E, nu):
    """Strain eps_z at depth z under the middle of a circular contact; stresses of [J] 3.45 (tension positive)."""
    s = np.maximum(z / a, 1e-12)
    sigma_r = -p0 * ((1.0 + nu) * (1.0 - s * np.arctan(1.0 / s)) - 0.5 / (1.0 + s**2))
    sigma_z = -p0 / (1.0 + s**2)
    return (sigma_z - 2.0 * nu * sigma_r) / E


def sphere_shortening(depth, a, p0, E, nu, points=4001):
    """How much the axis under a circular contact gets shorter between the surface and `depth`: - integral of eps_z."""
    z = np.linspace(0.0, depth, points)
    return -np.trapz(sphere_axis_strain(z, a, p0, E, nu), z)


def sphere_force_of_approach(approach, radius, materials, depths):
    """The force at which the points at `depths` on the axis of two bodies have approached by `approach`.

    The approach of far points depends on the size of the bodies; that of points a few contact radii away does not. It
    grows with the force, so the force is found by bisection.
    """
    modulus = contact_modulus(*materials)

    def approach_of(force):
        a, p0 = sphere_contact(force, radius, modulus)
        return sum(sphere_shortening(z, a, p0, E, nu) for z, (E, nu) in zip(depths, materials))

    low, high = 0.0, 1.0
    while approach_of(high) < approach:
        high *= 2.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if approach_of(middle) < approach else (low, middle)
    return high


def wave_closing_pressure(length, amplitude, E, nu):
    """Mean pressure p* at which a rigid plane touches all of a wave amplitude (1 - cos(2 pi x / length)), [J] 13.7."""
    return np.pi * E / (1.0 - nu**2) * amplitude / length


def wave_half_width(mean, closing, length):
    """Half-width a of the contact at each crest under a mean pressure, sin^2(pi a / length) = mean / p*, [J] 13.9."""
    return length / np.pi * np.arcsin(np.sqrt(mean / closing))


def wave_pressure(x, mean, closing, length):
    """Pressure on a wave pressed by a rigid plane (H. M. Westergaard, J. Appl. Mech. 6 (1939) 49-53), [J] 13.8."""
    inside = np.maximum(0.0, mean / closing - np.sin(np.pi * x / length) ** 2)
    return np.where(np.asarray(x) < length / 2.0, 2.0 * mean * np.cos(np.pi * x / length) * np.sqrt(inside) / (mean / closing), 0.0)


def flat_punch_pressure(x, force, a):
    """Pressure under a rigid flat punch of half-width a and `force` per length on a half-plane, [J] 2.64."""
    return force / (np.pi * np.sqrt(a**2 - np.asarray(x) ** 2))


def disc_shortening(force, R, a, E, nu):
    """Shortening of a disc's diameter between two opposite contacts of half-width a, plane strain: twice [J] 5.57."""
    return 2.0 * force * (1.0 - nu**2) / (np.pi * E) * (2.0 * np.log(4.0 * R / a) - 1.0)


def disc_widening(force, R, E, nu, points=4001):
    """Lengthening of the diameter across, from the stresses of a disc under two opposite point forces (Timoshenko and
    Goodier, Theory of Elasticity, section 41), integrated along it in plane strain."""
    x, D = np.linspace(-R, R, points), 2.0 * R
    scale = 2.0 * force / (np.pi * D)
    sigma_x = scale * ((D**2 - 4.0 * x**2) / (D**2 + 4.0 * x**2)) ** 2
    sigma_y = -scale * (4.0 * D**4 / (D**2 + 4.0 * x**2) ** 2 - 1.0)
    return np.trapz((1.0 + nu) / E * ((1.0 - nu) * sigma_x - nu * sigma_y), x)


def boxed_disc_forces(shortening_x, shortening_y, R, E, nu):
    """Contact forces (Q, P) across and down a disc whose diameters are shortened by the given amounts.

    Each force shortens its own diameter and widens the other: two equations, solved by fixed-point iteration (the
    shortening of a diameter is nearly linear in its force). The half-width at a contact with an equal disc and with a
    rigid wall is the same: half the effective radius, half the modulus.
    """
    P = Q = 0.0

    def force(total):
        low, high = 0.0, E * R
        for _ in range(100):
            middle = 0.5 * (low + high)
            a, _ = line_contact(middle, R, E / (1.0 - nu**2))
            low, high = (middle, high) if disc_shortening(middle, R, a, E, nu) < total else (low, middle)
        return high

    for _ in range(200):
        P = force(shortening_y + disc_widening(Q, R, E, nu))
        Q = force(shortening_x + disc_widening(P, R, E, nu))
    return Q, P


def uniaxial_plane_strain(pressure, E, nu):
    """(eps_x, eps_y) of a block under uniform pressure along y, free along x, plane strain."""
    return nu * (1.0 + nu) * pressure / E, -(1.0 - nu**2) * pressure / E


def slider_after_step(times, old_rate, new_rate, law, stiffness, evolution):
    """Friction coefficient of a massless spring slider with rate-and-state friction whose drive changes its rate at time 0.

    law: mu, a, b, L, v0; stiffness: per area, over the pressure (1/length); times > 0, ascending. Before the step it slides
    steadily. From f = mu + a ln(v/v0) + b theta and df/dt = k (V - v), with y = ln(v/v0):
        a dy/dt = k (V - v) - b dtheta/dt,   dtheta/dt = -(v/L)(theta + y)  (slip),  (v0/L) e^-theta - v/L  (ageing, where
    e^theta = v0 Theta / L). A. Ruina, J. Geophys. Res. 88 (1983) 10359-10370; J. H. Dieterich, 84 (1979) 2161-2168.
    """

    def rates(state):
        y, theta = state
        v = law["v0"] * np.exp(y)
        if evolution == "slip":
            dtheta = -v / law["L"] * (theta + y)
        else:
            dtheta = law["v0"] / law["L"] * np.exp(-theta) - v / law["L"]
        return np.array([(stiffness * (new_rate - v) - law["b"] * dtheta) / law["a"], dtheta])

    start = np.log(old_rate / law["v0"])
    states = runge_kutta(rates, np.array([start, -start]), times, 0.1 * law["a"] / (stiffness * new_rate))
    return law["mu"] + law["a"] * states[:, 0] + law["b"] * states[:, 1]


def runge_kutta(rates, start, times, largest_step):
    """States at `times` (ascending, after 0) of d state/dt = rates(state), by the classical method of order 4."""
    states, state, now = [], start, 0.0
    for time in times:
        count = int(np.ceil((time - now) / largest_step))
        h = (time - now) / count
        for _ in range(count):
            k1 = rates(state)
            k2 = rates(state + 0.5 * h * k1)
            k3 = rates(state + 0.5 * h * k2)
            k4 = rates(state + h * k3)
            state = state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        now = time
        states.append(state)
    return np.array(states)


def signorini_block(x, y, a, K, E, nu):
    """Displacements u_x, u_y of a block on the rigid plane y = 0, frictionless, in plane strain, that touches it for x < a
    with the pressure K sqrt(a - x).

    Westergaard's stress function ([J] 2.2 for the frictionless half-plane) with w = a - x - i y:
        Z = -K w^(1/2),  Zi = integral of Z dz = 2/3 K w^(3/2),  kappa = 3 - 4 nu,
        2 G u_x = (kappa - 1)/2 Re Zi - y Im Z,  2 G u_y = (kappa + 1)/2 Im Zi - y Re Z,
        sigma_yy = Re Z + y Im Z',  sigma_xy = -y Re Z'.
    On y = 0, x < a: Zi is real, so u_y = 0, and sigma_yy = -K sqrt(a - x). For x > a: Z is imaginary, so sigma_yy = 0, and
    u_y = (kappa + 1)/(6 G) K (x - a)^(3/2) > 0.
    """
    w = np.conj(a - np.asarray(x) + 1j * np.asarray(y))  # at y = 0 its imaginary part is -0: roots are limits from above
    Z, Zi = -K * np.sqrt(w), 2.0 / 3.0 * K * np.sqrt(w) ** 3
    kappa, double_G = 3.0 - 4.0 * nu, E / (1.0 + nu)
    return ((kappa - 1.0) / 2.0 * Zi.real - y * Z.imag) / double_G, ((kappa + 1.0) / 2.0 * Zi.imag - y * Z.real) / double_G


# Contact radius of the obstacle problem of PETSc's snes/tutorials/ex9.c (E. Bueler): obstacle sqrt(1 - r^2), zero at r = 2
BALL_RADIUS = 0.697965148223374


def membrane_over_ball(r, a):
    """Height of a membrane over the ball of radius 1 at the origin that it touches for r < a. Outside it is harmonic,
    -A ln(r) + B, and meets the ball with its value and slope: A = a^2/sqrt(1 - a^2)."""
    r = np.asarray(r)
    A = a**2 / np.sqrt(1.0 - a**2)
    inside = np.sqrt(np.maximum(0.0, 1.0 - r**2))
    return np.where(r < a, inside, np.sqrt(1.0 - a**2) - A * np.log(np.maximum(r, a) / a))


def membrane_force(a):
    """Force on the ball under a membrane of unit tension: 2 pi A by the slope outside."""
    return 2.0 * np.pi * a**2 / np.sqrt(1.0 - a**2)


def membrane_pressure(r, a):
    """- Laplacian of sqrt(1 - r^2) inside contact, zero outside."""
    r = np.asarray(r)
    return np.where(r < a, (2.0 - r**2) / np.maximum(1.0 - r**2, 1e-12) ** 1.5, 0.0)


def bisected(function, low, high):
    """The root of a function that rises from below zero at `low` to above at `high`."""
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) < 0.0 else (low, middle)
    return 0.5 * (low + high)


def inflated_cylinder_growth(pressure, shear_modulus, inner, outer):
    """Displacement of the bore of a long tube of incompressible neo-Hookean rubber under a pressure in it, plane strain.

    The volume inside a radius R grows by the same area everywhere, r² = R² + c, so the stretches are lam = r / R around and
    1 / lam along the radius. Equilibrium, d sigma_r / dr = G (lam² - lam^-2) / r, integrated over the wall:
    p = G [ln(lam_a / lam_b) + (lam_b^-2 - lam_a^-2) / 2] (R. S. Rivlin, Phil. Trans. R. Soc. A 242 (1949) 173-195).
    """

    def excess(stretch):
        outside = np.sqrt(1.0 + (stretch**2 - 1.0) * (inner / outer) ** 2)
        return shear_modulus * (np.log(stretch / outside) + 0.5 * (outside**-2 - stretch**-2)) - pressure

    return inner * (bisected(excess, 1.0, 100.0) - 1.0)


def voce(law, plastic_strain):
    return law["yield"] + law["Q"] * (1.0 - np.exp(-law["b"] * plastic_strain)) + law["H"] * plastic_strain


def round_bar_force(strain, law, radius):
    """Axial force of a uniform round bar at a logarithmic strain beyond yield, elasticity linear in logarithmic strain.

    Kirchhoff's stress is the yield stress, strain = yield(p) / E + p, and force = first section x Kirchhoff's stress / stretch.
    """
    hardening = law["hardening"]["voce"]
    p = bisected(lambda p: voce(hardening, p) / law["E"] + p - strain, 0.0, strain)
    return np.pi * radius**2 * voce(hardening, p) * np.exp(-strain)
