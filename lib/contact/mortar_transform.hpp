// The change of variables that turns non-penetration of all `vi` pairs into bounds on single unknowns (B. I. Wohlmuth,
// R. Krause, SIAM J. Sci. Comput. 25 (2003) 324-347; S. Hüeber, B. I. Wohlmuth, Comput. Methods Appl. Mech. Engrg. 194
// (2005) 3147-3166). Derivation at the top of mortar_transform.cpp.
#pragma once

#include "contact/mortar_form.hpp"
#include "form/bounded_unknowns.hpp"
#include "form/problem.hpp"

#include <vector>

namespace amontons {

class MortarTransform : public BoundedUnknowns {
 public:
  /// The forms belong to the problem, which must outlive this object. Throws UserError where two pairs would bind the
  /// same slave node, where a resultant holds a slave node along its normal, where no node of a pair is free to move
  /// along its normal, and where pairs form a ring. Collective.
  MortarTransform(const Problem& problem, std::vector<MortarForm*> pairs);

  bool update(double time) override;
  Mat transform() const override { return transform_; }
  Mat inverse() const override { return inverse_; }
  Vec lower() const override { return lower_; }
  void hold_forces(Vec forces) override;
  void release() override;

 private:
  enum class Hold : std::uint8_t { Free, Prescribed, Tied };
  /// How a node stands to its bound: the unit normal within the components that are free, and its length before it was
  /// made one; the bounded unknown takes the place of component `host`.
  struct Frame {
    bool bounded = false;
    int host = 0;
    double length = 0.0;
    std::array<double, 3> normal{};
  };
  struct Entries; // of a matrix, to be summed up
  Frame frame(const MortarForm& pair, std::size_t place) const;
  Hold hold(std::int32_t node, int component) const { return hold_[std::size_t(node) * dim_ + component]; }
  void find_held();
  void check_pairs() const;
  void build();
  MatHandle reflections() const;
  MatHandle couplings() const;
  void couple_to_master(const MortarForm& pair, Entries& entries) const;
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
  std::vector<std::vector<Frame>> frames_;        // per pair and node
  MatHandle transform_, inverse_;
  VecHandle lower_;
};

} // namespace amontons
