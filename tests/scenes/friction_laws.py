"""The friction laws as a table: shear limit and state at the end of an increment of constant slip rate.

Each takes the law's parameters, the pressure p, the slip s and duration dt of the increment and the state at its start (None: contact
begins), and returns (limit, state). Written from the cited equations, not from the program; rate and state with the plain logarithm.
"""
import numpy as np


def coulomb(law, p, s, dt, state):
    return law.get("cohesion", 0.0) + law["mu"] * p, None


def tresca(law, p, s, dt, state):
    return law["tau_max"], None


def orowan(law, p, s, dt, state):  # E. Orowan, Proc. Inst. Mech. Eng. 150 (1943) 140-167
    return min(law["mu"] * p, law["tau_max"]), None


def shaw(law, p, s, dt, state):  # E. Usui, T. Shirakashi, ASME PED 7 (1982) 13-35
    return law["tau_max"] * (1.0 - np.exp(-law["mu"] * p / law["tau_max"])), None


def static_kinetic(law, p, s, dt, state):
    slides = s > 0.0
    return (law["mu_k"] if slides or state else law["mu_s"]) * p, slides


def velocity_weakening(law, p, s, dt, state):  # L. C. Bo, D. Pavelescu, Wear 82 (1982) 277-289
    return p * (law["mu_k"] + (law["mu_s"] - law["mu_k"]) * np.exp(-s / dt / law["v_c"])), None


def weakening_strengthening(law, p, s, dt, state):
    return velocity_weakening(law, p, s, dt, state)[0] + p * law["kappa"] * s / dt, None


def slip_weakening(law, p, s, dt, state):  # Y. Ida, J. Geophys. Res. 77 (1972) 3796-3805
    slip = (state or 0.0) + s
    return p * (law["mu_s"] - (law["mu_s"] - law["mu_k"]) * min(slip / law["D_c"], 1.0)), slip


def rate_and_state(law, p, s, dt, state):  # A. Ruina, J. Geophys. Res. 88 (1983) 10359-10370, slip law
    log_rate = np.log(s / dt / law["v0"])
    theta = -log_rate + ((state or 0.0) + log_rate) * np.exp(-s / law["L"])
    return p * (law["mu"] + law["a"] * log_rate + law["b"] * theta), theta


def prakash_clifton(law, p, s, dt, state):  # A. Cochard, J. R. Rice, J. Geophys. Res. 105 (2000) 25891-25907
    aim = law["mu"] * p
    resistance = aim if state is None else aim + (state - aim) * np.exp(-s / law["L"])
    return resistance, resistance


LAWS = {law.__name__: law for law in (coulomb, tresca, orowan, shaw, static_kinetic, velocity_weakening,
                                      weakening_strengthening, slip_weakening, rate_and_state, prakash_clifton)}
