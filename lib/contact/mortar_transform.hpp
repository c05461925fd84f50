// The change of variables that turns non-penetration of all pairs with the dual basis into bounds on single unknowns,
// and their tangential motion into the unknowns next to them (B. I. Wohlmuth, R. Krause, SIAM J. Sci. Comput. 25 (2003)
// 324-347; S. Hüeber, B. I. Wohlmuth, Comput. Methods Appl. Mech. Engrg. 194 (2005) 3147-3166). Derivation at the top
// of mortar_transform.cpp.
#pragma once

#include "contact/mortar_form.hpp"
#include "form/bounded_unknowns.hpp"
#include "form/problem.hpp"

#include <vector>

namespace amontons {

/// How a node stands to its constraint: the unit normal within the components that are free, and its length before it
/// was made one. The unknowns in place of the node's free components are relative motions along axis(c): the bounded
/// one, along the normal, in place of `host`, the others in tangential directions.
struct NodeFrame {
  bool bounded = false;
  int host = 0;
  double length = 0.0;
  std::array<double, 3> normal{};
  std::array<bool, 3> is_free{};

  /// Column of the reflection that takes the host's direction to the normal; `component` is free.
  std::array<double, 3> axis(int component) const;
};

/// Reference position of a node, in the plane with a third component of zero.
std::array<double, 3> node_place(const Mesh& mesh, std::int32_t node);

class MortarTransform : public BoundedUnknowns {
 public:
  /// The forms belong to the problem, which must outlive this object. Leaves out slave nodes whose support hides the
  /// contact force, and those that an earlier pair has (MortarForm::leave_out). Throws UserError where a slave facet
  /// has no node left, and where pairs form a ring. Collective.
  MortarTransform(const Problem& problem, std::vector<MortarForm*> pairs);

  bool update(double time) override;
  Mat transform() const override { return transform_; }
  Mat inverse() const override { return inverse_; }
  std::vector<Set> sets() const override;
  Vec lower() const override { return lower_; }
  void hold_forces(Vec forces) override;
  void release() override;

  const std::vector<MortarForm*>& pairs() const { return pairs_; }
  /// At the nodes() of pair `p`, as of the last update.
  const std::vector<NodeFrame>& frames(std::size_t p) const { return frames_[p]; }

 private:
  /// Fixed: prescribed to stay where it is.
  enum class Hold : std::uint8_t { Free, Fixed, Prescribed, Tied };
  struct Entries; // of a matrix, to be summed up
  NodeFrame frame(const MortarForm& pair, std::size_t place) const;
  Hold hold(std::int32_t node, int component) const { return hold_[std::size_t(node) * dim_ + component]; }
  void find_held();
  void leave_out_nodes();
  void refuse_facet(const MortarForm& pair, std::int32_t facet, const std::vector<const MortarForm*>& owners) const;
  std::vector<std::uint8_t> find_held_nodes(const MortarForm& pair) const;
  std::vector<std::array<double, 2>> symmetry_planes(const MortarForm& pair) const;
  void build();
  MatHandle reflections() const;
  MatHandle couplings() const;
  void couple(const MortarForm& pair, std::size_t place, std::span<const PetscInt> columns, double coefficient,
              Entries& entries) const;
  void couple_to_master(const MortarForm& pair, Entries& entries) const;
  void couple_to_left_out(const MortarForm& pair, Entries& entries) const;
  void couple_to_held(const MortarForm& pair, Entries& entries) const;
  enum class Direction : std::uint8_t { ToNodes, ToControls };
  MatHandle control_change(Direction direction) const;
  void add_control_rows(const MortarForm& pair, Direction direction, Entries& entries) const;
  MatHandle assemble(const Entries& entries) const;
  void set_bounds();
  std::string node_text(std::int32_t node) const;

  const Problem& problem_;
  const DofLayout& layout_;
  int dim_;
  std::vector<MortarForm*> pairs_;
  std::vector<Hold> hold_;                        // per local node and component
  std::vector<double> facet_totals_;              // per local node: of all pairs
  std::vector<std::vector<double>> facet_counts_; // per pair and node: facets that meet there, over all ranks
  std::vector<std::vector<NodeFrame>> frames_;    // per pair and node
  MatHandle transform_, inverse_;
  VecHandle lower_;
};

} // namespace amontons
