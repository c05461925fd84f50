// How far a figure is from its limit, judged by its values on successively better meshes. Pure function.
#pragma once

#include <optional>
#include <span>

namespace amontons {

/// Error of the last of `values`, relative to it, from the values on successive meshes and the errors of these meshes
/// in the energy norm (both from first to last, of equal length). Absent with fewer than three meshes and for a last
/// value of zero.
///
/// With q_k = q + c e_k^s the last error is |q_k - q_(k-1)| ρ^s / (1 - ρ^s), ρ = e_k / e_(k-1) (L. F. Richardson, Phil.
/// Trans. R. Soc. A 210 (1911)). Figures that depend smoothly on the solution have s = 2 or nearly so; s = 1 is taken,
/// which is on the safe side. Two values may be equal by chance, so the step before counts as well, as if it had gone
/// down by ρ: the step is max(|q_k - q_(k-1)|, ρ |q_(k-1) - q_(k-2)|). ρ counts as at most 0.8 (a factor of 4), for on
/// meshes that hardly differ the ratio tells nothing. An indication, no bound: c may change sign between meshes.
std::optional<double> sequence_error(std::span<const double> values, std::span<const double> energy_errors);

} // namespace amontons
