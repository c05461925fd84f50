// Shapes that a straight strip (strip.hpp) is folded to: places in the plane of its length and thickness.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <numbers>

namespace amontons::test {

/// Place of the strip's material point at `s` along it and `eta` above its bottom.
using Fold = std::function<Eigen::Vector2d(double s, double eta)>;

/// The length that the bend of a hairpin takes; its legs share the rest.
constexpr double hairpin_bend = 0.8;

/// Two straight legs, the upper one turned over, their top faces `gap` apart. The bend is a drop, wide inside, so that
/// nothing but the legs meets.
inline Fold hairpin(double length, double thickness, double gap) {
  const double leg = 0.5 * (length - hairpin_bend), radius = hairpin_bend / std::numbers::pi, half = 0.5 * gap;
  return [=](double s, double eta) {
    const double below = thickness - eta; // the top face
    if (s <= leg) return Eigen::Vector2d(s, -half - below);
    if (s >= leg + hairpin_bend) return Eigen::Vector2d(length - s, half + below);
    const double angle = std::numbers::pi * (s - leg) / hairpin_bend;
    const double height = -std::cos(angle) * (half + radius * std::pow(std::sin(angle), 2) + below);
    return Eigen::Vector2d(leg + (radius + below) * std::sin(angle), height);
  };
}

} // namespace amontons::test
