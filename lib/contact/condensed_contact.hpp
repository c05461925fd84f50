// Frictional and frictionless contact of all pairs with `semismooth: {basis: dual}` as conditions on relative motions:
// multipliers of the dual basis, eliminated node by node. Derivation at the top of condensed_contact.cpp.
#pragma once

#include "contact/mortar_transform.hpp"
#include "form/condensed_unknowns.hpp"

#include <memory>
#include <vector>

namespace amontons {

class CondensedContact : public CondensedUnknowns {
 public:
  /// As MortarTransform. Collective.
  CondensedContact(const Problem& problem, const std::vector<MortarForm*>& pairs);
  ~CondensedContact() override;

  bool update(double time) override;
  Mat transform() const override { return transform_.transform(); }
  Mat inverse() const override { return transform_.inverse(); }
  void release() override { transform_.release(); }
  void evaluate(Vec changed, Vec forces, Evaluation evaluation, Vec residual) override;
  std::span<const ConditionRows> rows() const override { return rows_; }
  void hold() override;
  std::vector<Switching*> switching() override;

 private:
  /// A constraint of this rank at the last evaluation.
  struct Node {
    std::size_t pair, place; // in nodes() of the pair
    std::int32_t first;      // unknown of component 0, as a number of this rank
    double motion = 0.0;     // û_h less its bound, length
    double augmented = 0.0;  // λ̂
    bool closed = false;
    bool wanted = false;          // closed, were it not held
    std::array<double, 3> jump{}; // u_slave − u_master − rigid shift
    TangentVector trial{};        // q, with friction
    FrictionResponse response{};
  };
  /// What detection and remedies see of the nodes of one pair.
  class PairNodes;
  const MortarForm& pair(const Node& node) const { return *transform_.pairs()[node.pair]; }
  const NodeFrame& frame(const Node& node) const { return transform_.frames(node.pair)[node.place]; }
  const MortarForm::Constraint& constraint(const Node& node) const { return pair(node).constraints()[node.place]; }
  double gap(const Node& node) const { return constraint(node).leverage() * frame(node).length * node.motion; }
  void collect_nodes();
  void find_normal_part(const VecReader& changed, const VecReader& forces);
  void guess_contact();
  void apply_holds();
  double epsilon(const Node& node) const;
  void find_tangential_part(Node& node, const VecReader& changed, const VecReader& forces, Evaluation evaluation) const;
  void set_residual(const Node& node, Vec residual) const;
  ConditionRows rows_of(const Node& node) const;
  void hold_friction(std::size_t pair);

  const Problem& problem_;
  MortarTransform transform_;
  std::vector<Node> nodes_;
  std::vector<ConditionRows> rows_;
  std::vector<std::unique_ptr<PairNodes>> switching_; // one a pair
  double time_ = 0.0;
};

} // namespace amontons
