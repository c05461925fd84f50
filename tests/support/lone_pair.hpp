// A problem of nothing but one contact pair, for tests of its forces and tangents at displacements given by formulas.
#pragma once

#include "contact/contact_form.hpp"
#include "form/problem.hpp"

#include <Eigen/Core>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace amontons::test {

struct LonePair {
  Mesh mesh;
  std::vector<NodeField> fields; // of multipliers, where they are unknowns
  std::unique_ptr<DofLayout> layout;
  std::unique_ptr<Problem> problem;
  ContactForm* form = nullptr;
  VecHandle u;

  /// `pair`: where its friction has its multipliers need not be said. Collective.
  LonePair(Mesh given, ContactPair pair) : mesh(std::move(given)) {
    const bool unknown = std::holds_alternative<Semismooth>(pair.enforcement);
    if (unknown) fields.assign(pair.friction ? 1 + mesh.dim : 1, multiplier_nodes(mesh, pair.name, pair.slave));
    if (pair.friction) pair.friction->field = unknown ? 1 : -1;
    layout = std::make_unique<DofLayout>(mesh, std::vector<TiedGroup>{}, fields);
    auto contact = std::make_unique<ContactForm>(*layout, std::move(pair));
    form = contact.get();
    std::vector<std::unique_ptr<Form>> forms;
    forms.push_back(std::move(contact));
    problem = std::make_unique<Problem>(*layout, std::move(forms), std::vector<PrescribedDisplacement>{});
    u = layout->new_vector();
  }

  Eigen::Vector3d reference(std::int32_t node) const {
    Eigen::Vector3d X = Eigen::Vector3d::Zero();
    for (int c = 0; c < mesh.dim; ++c)
      X[c] = mesh.position(node)[c];
    return X;
  }
};

/// In [-1, 1], from the place alone: the same on any number of ranks.
inline double noise(const Eigen::Vector3d& X, int component, int seed) {
  const double s = std::sin(12.9898 * X[0] + 78.233 * X[1] + 37.719 * X[2] + 4.1 * component + 1.7 * seed) * 43758.5453;
  return 2.0 * (s - std::floor(s)) - 1.0;
}

} // namespace amontons::test
