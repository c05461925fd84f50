// Adaptive meshing: what is handed from one pass (a whole run on one mesh) to the next, and whether there is a next.
#pragma once

#include "accuracy/discretization_error.hpp"
#include "accuracy/mesh_sizes.hpp"
#include "contact/pair_report.hpp"
#include "deck.hpp"
#include "goal_errors.hpp"
#include "mesh/build.hpp"
#include "scene.hpp"

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace amontons {

/// What a pass has come to at the end of its history.
struct PassResult {
  std::int64_t unknowns = 0, cells = 0;
  double energy = 0.0;              // stored
  std::vector<ContactTotals> pairs; // in the order of the deck
  double mesh_error = 0.0;          // relative, in the energy norm
  std::optional<double> figure;     // relative error of the quantity where the influence of cells on it is known
  double wall_seconds = 0.0;        // of this pass
};

class Adaptation {
 public:
  explicit Adaptation(const Deck& deck);

  /// How the mesh of this pass is to be made. `sizes` are there on rank 0 only.
  const FreeMeshing& meshing() const { return meshing_; }
  /// When the first pass began, in seconds of the wall clock.
  double started() const { return started_; }
  /// 1 for the first mesh.
  int pass() const { return static_cast<int>(results_.size()) + 1; }

  /// May a mesh with so many unknowns be solved on? If not, sizes have been enlarged, and the mesh is to be made again.
  /// Throws UserError for a first mesh that is too large: its sizes are the script's.
  bool fits(std::int64_t unknowns);

  /// Takes the error at the end of a step: cells are made for the worst of them. Where the quantity is among the
  /// figures, by their influence on it; else by their part of the energy norm. Collective.
  void see(const Scene& scene, const DiscretizationError& error, const FigureErrors& figures);
  /// The quantity's error among the figures; absent where it is none of them.
  std::optional<double> figure_error(const FigureErrors& figures) const;

  /// The pass is at its end: judges the quantity's error and, where it is too large, chooses the sizes of the next
  /// mesh. Collective.
  void close(MPI_Comm comm, PassResult result);

  bool goes_on() const { return verdict_ == Verdict::GoesOn; }
  /// `adapt` of the summary.
  nlohmann::ordered_json to_json() const;
  /// The last pass in a line for the log.
  std::string sentence() const;

 private:
  enum class Verdict { GoesOn, Reached, UnknownsSpent, PassesSpent };

  const FigureError* figure(const FigureErrors& figures) const;
  double value(const PassResult& result) const;
  std::optional<double> estimate() const;
  double reduction(std::optional<double> error) const;
  bool choose_sizes(MPI_Comm comm, double reduction);
  void set_sizes(double factor);

  double started_;
  AdaptDeck adapt_;
  Place first_mesh_; // where the deck says how the first mesh is made
  int dim_;
  std::size_t pair_ = 0;
  FreeMeshing meshing_;
  std::vector<SizeSample> samples_;     // on rank 0
  std::vector<double> squares_;         // of this rank's cells, the largest of the ends of steps
  std::vector<CellError> cells_;        // on rank 0
  std::vector<std::uint8_t> near_edge_; // of this rank's cells, at any of them
  std::vector<PassResult> results_;
  std::vector<std::optional<double>> errors_; // of the quantity, one a pass
  Verdict verdict_ = Verdict::GoesOn;
};

} // namespace amontons
