// Slave node k with unit normal n_k: gap_k = g_k + n_k · (c_k − Σ_j P_kj u_j) (mortar_form.cpp). With
//   c_k = Q_k û_k + Σ_j P_kj u_j,   Q_k orthogonal with n_k as the column of component h ("host")
// this is gap_k = g_k + û_kh: a lower bound −g_k on one unknown. The force on it is f = D_k λ_k.
//
// Components that are prescribed or tied to a group ("held") keep their meaning, û_c = u_c, and only the others turn:
// with n split into its free part ñ and its held part,
//   gap = g + ñ · (c − P u)_free + n_held · (c − P u)_held,
// so c_free = Q û_free + (P u)_free + ñ/|ñ|² [n_held · (P u − c)_held] makes gap / |ñ| = g / |ñ| + û_h.
//
// Q is a reflection, so it is its own inverse. Collecting, c = R û + N u, and u = B c turns controls into nodal values
// (the identity for order 1): u = B R û + B N u. A master node that is itself a slave node of another pair has entries
// of its own in N; unless the pairs form a ring, (B N)^m = 0 for some m <= number of pairs, and
//   T = (I + B N + ... + (B N)^(m-1)) B R,   T⁻¹ = R (B⁻¹ − N).
#include "contact/mortar_transform.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace amontons {

namespace {

/// As a deck says it.
std::string enforce_text(const MortarForm& pair) {
  return std::holds_alternative<BoundConstraint>(pair.pair().enforcement) ? "enforce: {vi: {}}"
                                                                          : "enforce: {semismooth: {basis: dual}}";
}

/// A node of whose normal less than this is free has no constraint: the supports decide where it goes.
constexpr double least_free_normal = 0.1;
/// Nodes this near to a plane of symmetry are on it; relative to the facets' size.
constexpr double same_plane = 1e-6;

MatHandle product(Mat a, Mat b) {
  MatHandle result;
  AMT_PETSC(MatMatMult(a, b, MAT_INITIAL_MATRIX, PETSC_DEFAULT, result.put()));
  return result;
}

} // namespace

struct MortarTransform::Entries {
  std::vector<PetscInt> rows, columns;
  std::vector<double> values;
  void add(PetscInt row, PetscInt column, double value) {
    rows.push_back(row);
    columns.push_back(column);
    values.push_back(value);
  }
};

MortarTransform::MortarTransform(const Problem& problem, std::vector<MortarForm*> pairs)
    : problem_(problem), layout_(problem.layout()), dim_(problem.layout().dim()), pairs_(std::move(pairs)) {
  find_held();
  facet_totals_.assign(layout_.mesh().num_local(), 0.0);
  for (const auto* pair : pairs_) {
    const NodeSpace space(layout_.mesh(), {pair->nodes()});
    std::vector<std::vector<double>> counts(1, std::vector<double>(pair->nodes().nodes.size(), 0.0));
    for (const auto node : pair->slave().nodes)
      counts[0][pair->place(node)] += 1.0;
    const auto global = space.new_vector();
    space.add(counts, global);
    space.gather(global, counts);
    for (std::size_t i = 0; i < counts[0].size(); ++i)
      facet_totals_[pair->nodes().nodes[i]] += counts[0][i];
    facet_counts_.push_back(std::move(counts[0]));
  }
  leave_out_nodes();
  build();
}

void MortarTransform::find_held() {
  const auto& mesh = layout_.mesh();
  hold_.assign(std::size_t(mesh.num_local()) * dim_, Hold::Free);
  for (const auto& condition : problem_.prescribed())
    for (const auto node : mesh.node_groups.at(condition.group))
      hold_[std::size_t(node) * dim_ + condition.component] =
          condition.value.is_constant() && condition.value(0.0) == 0.0 ? Hold::Fixed : Hold::Prescribed;
  for (const auto& tied : layout_.tied())
    for (const auto node : mesh.node_groups.at(tied.group))
      hold_[std::size_t(node) * dim_ + tied.component] = Hold::Tied;
}

/// A node has one relative motion: that of the first pair that covers it. In other pairs, and where it is held, it is
/// left out. Collective.
void MortarTransform::leave_out_nodes() {
  std::vector<std::vector<std::int32_t>> bare;
  std::vector<const MortarForm*> owners(layout_.mesh().num_local(), nullptr);
  for (auto* pair : pairs_) {
    auto left_out = find_held_nodes(*pair);
    for (std::size_t i = 0; i < left_out.size(); ++i) {
      auto& owner = owners[pair->nodes().nodes[i]];
      if (pair->constraints()[i].weight == 0.0 || left_out[i]) continue;
      if (owner)
        left_out[i] = 1;
      else
        owner = pair;
    }
    bare.push_back(pair->leave_out(left_out));
  }
  together(layout_.mesh().comm, [&] {
    for (std::size_t p = 0; p < pairs_.size(); ++p)
      for (const auto facet : bare[p])
        refuse_facet(*pairs_[p], facet, owners);
  });
}

std::array<double, 3> node_place(const Mesh& mesh, std::int32_t node) {
  std::array<double, 3> place{};
  std::ranges::copy(mesh.position(node), place.begin());
  return place;
}

std::vector<MortarTransform::Set> MortarTransform::sets() const {
  const auto& mesh = layout_.mesh();
  std::vector<Set> sets;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    auto& set = sets.emplace_back(Set{.name = pairs_[p]->pair().name, .places = {}, .unknowns = {}});
    for (std::size_t i = 0; i < frames_[p].size(); ++i) {
      const auto node = pairs_[p]->nodes().nodes[i];
      if (node >= mesh.num_owned) continue;
      const auto& frame = frames_[p][i];
      set.places.push_back(node_place(mesh, node));
      set.unknowns.push_back(frame.bounded ? PetscInt(node) * dim_ + frame.host : -1);
    }
  }
  return sets;
}

/// Throws: no node of the facet can have a multiplier of this pair.
void MortarTransform::refuse_facet(const MortarForm& pair, std::int32_t facet,
                                   const std::vector<const MortarForm*>& owners) const {
  const auto nodes = pair.slave().facet(facet);
  const auto shared = std::find_if(nodes.begin(), nodes.end(),
                                   [&](std::int32_t node) { return owners[node] && owners[node] != &pair; });
  if (shared != nodes.end())
    throw UserError("the contact pairs '" + owners[*shared]->pair().name + "' and '" + pair.pair().name + "' with " +
                    enforce_text(pair) + " share the slave node at " + node_text(*shared) +
                    " and leave none of its own to the slave facet there; a node can have one master only. Leave a "
                    "facet between the slave surfaces, exchange slave and master of one pair, or use `enforce: "
                    "{semismooth: {}}`.");
  throw UserError("the contact pair '" + pair.pair().name + "' with " + enforce_text(pair) +
                  ": all nodes of its slave facet at " + node_text(nodes[0]) +
                  " have prescribed displacements or resultants along the contact normal" +
                  (pair.friction() ? " or across it, where friction acts" : "") +
                  ", so that contact forces cannot be told from those of the supports. Exchange slave and master, or "
                  "use `enforce: {semismooth: {}}`.");
}

/// Nodes that a support holds along the normal; with friction also those that it holds across, unless it is a plane of
/// symmetry, where nothing slides: the support is at rest there, and so is the master in that direction. Collective.
std::vector<std::uint8_t> MortarTransform::find_held_nodes(const MortarForm& pair) const {
  const auto& mesh = layout_.mesh();
  const auto planes = symmetry_planes(pair);
  const auto* rigid = std::get_if<RigidMaster>(&pair.pair().master);
  const auto is_symmetry = [&](std::size_t place, int c) {
    const auto node = pair.nodes().nodes[place];
    if (hold(node, c) != Hold::Fixed) return false;
    if (rigid) return !rigid->displacement[c].has_value();
    const double reach = same_plane * pair.constraints()[place].size;
    return std::any_of(planes.begin(), planes.end(), [&](const auto& plane) {
      return plane[0] == c && std::abs(plane[1] - mesh.position(node)[c]) <= reach;
    });
  };
  std::vector<std::uint8_t> held(pair.nodes().nodes.size(), 0);
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (pair.constraints()[i].weight == 0.0) continue;
    held[i] = !frame(pair, i).bounded;
    for (int c = 0; pair.friction() && c < dim_; ++c)
      if (hold(pair.nodes().nodes[i], c) != Hold::Free && !is_symmetry(i, c)) held[i] = 1;
  }
  return held;
}

/// Component and coordinate of each plane in which nodes of a frictional pair's master are fixed in the direction
/// across it, from all ranks. Collective.
std::vector<std::array<double, 2>> MortarTransform::symmetry_planes(const MortarForm& pair) const {
  const auto* master = std::get_if<std::string>(&pair.pair().master);
  if (!master || !pair.friction()) return {};
  const auto& mesh = layout_.mesh();
  std::vector<std::array<double, 2>> mine;
  for (const auto node : mesh.node_groups.at(*master))
    for (int c = 0; c < dim_; ++c) {
      const std::array<double, 2> plane = {double(c), mesh.position(node)[c]};
      if (hold(node, c) == Hold::Fixed && std::find(mine.begin(), mine.end(), plane) == mine.end())
        mine.push_back(plane);
    }
  const int size = static_cast<int>(2 * mine.size());
  int ranks = 1;
  MPI_Comm_size(mesh.comm, &ranks);
  std::vector<int> sizes(ranks), offsets(ranks + 1, 0);
  MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, mesh.comm);
  std::partial_sum(sizes.begin(), sizes.end(), offsets.begin() + 1);
  std::vector<std::array<double, 2>> all(offsets.back() / 2);
  MPI_Allgatherv(mine.data(), size, MPI_DOUBLE, all.data(), sizes.data(), offsets.data(), MPI_DOUBLE, mesh.comm);
  return all;
}

std::string MortarTransform::node_text(std::int32_t node) const {
  std::string text = "(";
  for (const double x : layout_.mesh().position(node))
    text.append(text.size() > 1 ? ", " : "").append(std::to_string(x));
  return text.append(")");
}

std::array<double, 3> NodeFrame::axis(int component) const {
  std::array<double, 3> axis{}, mirror = normal;
  mirror[host] -= 1.0;
  const double square = mirror[0] * mirror[0] + mirror[1] * mirror[1] + mirror[2] * mirror[2];
  axis[component] = 1.0;
  for (int r = 0; r < 3 && square > 0.0; ++r)
    axis[r] -= 2.0 * mirror[r] * mirror[component] / square;
  return axis;
}

NodeFrame MortarTransform::frame(const MortarForm& pair, std::size_t place) const {
  const auto node = pair.nodes().nodes[place];
  const auto& constraint = pair.constraints()[place];
  NodeFrame frame;
  if (constraint.weight == 0.0) return frame;
  for (int c = 0; c < dim_; ++c) {
    frame.is_free[c] = hold(node, c) == Hold::Free;
    if (frame.is_free[c]) frame.normal[c] = constraint.normal[c];
  }
  frame.length = std::hypot(frame.normal[0], frame.normal[1], frame.normal[2]);
  if (frame.length < least_free_normal) return frame;
  frame.bounded = true;
  // The reflection that takes the host's axis to the normal is best defined where the two are farthest apart.
  double smallest = 2.0;
  for (int c = 0; c < dim_; ++c) {
    frame.normal[c] /= frame.length;
    if (!frame.is_free[c] || frame.normal[c] >= smallest) continue;
    smallest = frame.normal[c];
    frame.host = c;
  }
  return frame;
}

bool MortarTransform::update(double time) {
  bool moved = false;
  for (auto* pair : pairs_)
    moved = pair->move_rigid_master(time) || moved;
  if (moved) build();
  return moved;
}

MatHandle MortarTransform::assemble(const Entries& entries) const {
  MatHandle matrix;
  AMT_PETSC(MatCreate(problem_.comm(), matrix.put()));
  AMT_PETSC(MatSetSizes(matrix, layout_.num_owned(), layout_.num_owned(), PETSC_DETERMINE, PETSC_DETERMINE));
  AMT_PETSC(MatSetType(matrix, MATAIJ));
  AMT_PETSC(MatSetBlockSize(matrix, dim_));
  auto rows = entries.rows, columns = entries.columns; // PETSc sorts in them
  AMT_PETSC(MatSetPreallocationCOO(matrix, static_cast<PetscCount>(rows.size()), rows.data(), columns.data()));
  AMT_PETSC(MatSetValuesCOO(matrix, entries.values.data(), ADD_VALUES));
  return matrix;
}

/// R: reflections at bounded nodes, the identity elsewhere.
MatHandle MortarTransform::reflections() const {
  const auto& mesh = layout_.mesh();
  Entries entries;
  std::vector<std::uint8_t> turned(mesh.num_owned, 0);
  for (std::size_t p = 0; p < pairs_.size(); ++p)
    for (std::size_t i = 0; i < frames_[p].size(); ++i) {
      const auto node = pairs_[p]->nodes().nodes[i];
      const auto& frame = frames_[p][i];
      if (!frame.bounded || node >= mesh.num_owned) continue;
      turned[node] = 1;
      const PetscInt first = layout_.first_equation() + PetscInt(node) * dim_;
      for (int c = 0; c < dim_; ++c) {
        if (!frame.is_free[c]) {
          entries.add(first + c, first + c, 1.0);
          continue;
        }
        const auto axis = frame.axis(c);
        for (int r = 0; r < dim_; ++r)
          if (frame.is_free[r]) entries.add(first + r, first + c, axis[r]);
      }
    }
  for (PetscInt local = 0; local < layout_.num_owned(); ++local)
    if (local >= PetscInt(mesh.num_owned) * dim_ || !turned[local / dim_])
      entries.add(layout_.first_equation() + local, layout_.first_equation() + local, 1.0);
  return assemble(entries);
}

/// Adds to the rows of N of a slave node's free components how far a displacement at `columns`, dim of them, moves its
/// control.
void MortarTransform::couple(const MortarForm& pair, std::size_t i, std::span<const PetscInt> columns,
                             double coefficient, Entries& entries) const {
  const auto p = static_cast<std::size_t>(std::find(pairs_.begin(), pairs_.end(), &pair) - pairs_.begin());
  const auto& frame = frames_[p][i];
  if (!frame.bounded) return;
  const auto node = pair.nodes().nodes[i];
  for (int r = 0; r < dim_; ++r) {
    if (!frame.is_free[r]) continue;
    const PetscInt row = layout_.equation(node, r);
    entries.add(row, columns[r], coefficient);
    for (int c = 0; c < dim_; ++c)
      if (!frame.is_free[c])
        entries.add(row, columns[c], coefficient * frame.normal[r] * pair.constraints()[i].normal[c] / frame.length);
  }
}

/// Masters' part of N.
void MortarTransform::couple_to_master(const MortarForm& pair, Entries& entries) const {
  if (!pair.master()) return;
  const auto rows = pair.master_rows();
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const auto& [other, coefficient] : rows[i])
      couple(pair, i, pair.master()->equations(other), coefficient, entries);
}

/// Part of N by slave nodes that are left out.
void MortarTransform::couple_to_left_out(const MortarForm& pair, Entries& entries) const {
  for (const auto& [place, node, coefficient] : pair.left_out_rows())
    couple(pair, place, layout_.equations().subspan(std::size_t(node) * dim_, dim_), -coefficient, entries);
}

/// Part of N by the held components of the slave nodes themselves: −c_held with c in terms of nodal values. Facets that
/// meet at a node say the same; each adds its share.
void MortarTransform::couple_to_held(const MortarForm& pair, Entries& entries) const {
  const auto p = static_cast<std::size_t>(std::find(pairs_.begin(), pairs_.end(), &pair) - pairs_.begin());
  const auto& slave = pair.slave();
  for (std::int32_t f = 0; f < slave.size(); ++f) {
    const auto nodes = slave.facet(f);
    const auto& controls = controls_from_nodes(slave.types[f]);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const auto i = pair.place(nodes[k]);
      const auto& frame = frames_[p][i];
      if (!frame.bounded) continue;
      for (int r = 0; r < dim_; ++r)
        for (int c = 0; c < dim_; ++c) {
          if (hold(nodes[k], r) != Hold::Free || hold(nodes[k], c) == Hold::Free) continue;
          const double factor =
              frame.normal[r] * pair.constraints()[i].normal[c] / (frame.length * facet_counts_[p][i]);
          for (std::size_t a = 0; a < nodes.size(); ++a)
            if (controls(k, a) != 0.0)
              entries.add(layout_.equation(nodes[k], r), layout_.equation(nodes[a], c), -factor * controls(k, a));
        }
    }
  }
}

MatHandle MortarTransform::couplings() const {
  Entries entries;
  for (const auto* pair : pairs_) {
    couple_to_master(*pair, entries);
    couple_to_left_out(*pair, entries);
    couple_to_held(*pair, entries);
  }
  return assemble(entries);
}

/// Rows of B or B⁻¹ at the middle nodes of a pair's slave facets. Held components are nodal values on both sides, so a
/// held control that another row needs is spelled out: twice the middle less half of each end of its edge.
void MortarTransform::add_control_rows(const MortarForm& pair, Direction direction, Entries& entries) const {
  const auto& slave = pair.slave();
  for (std::int32_t f = 0; f < slave.size(); ++f) {
    const auto nodes = slave.facet(f);
    const int vertices = num_vertices(slave.types[f]);
    const auto& to_nodes = nodes_from_controls(slave.types[f]);
    const auto& to_controls = controls_from_nodes(slave.types[f]);
    for (std::size_t a = vertices; a < nodes.size(); ++a)
      for (int c = 0; c < dim_; ++c) {
        if (hold(nodes[a], c) != Hold::Free) continue;
        const double share = 1.0 / facet_totals_[nodes[a]];
        Eigen::RowVectorXd row = to_controls.row(a);
        if (direction == Direction::ToNodes) {
          row = to_nodes.row(a);
          for (std::size_t k = vertices; k < nodes.size(); ++k)
            if (k != a && hold(nodes[k], c) != Hold::Free) {
              const double factor = row[k];
              row[k] = 0.0;
              row += factor * to_controls.row(k);
            }
        }
        for (std::size_t k = 0; k < nodes.size(); ++k)
          if (row[k] != 0.0) entries.add(layout_.equation(nodes[a], c), layout_.equation(nodes[k], c), share * row[k]);
      }
  }
}

/// B or its inverse.
MatHandle MortarTransform::control_change(Direction direction) const {
  Entries entries;
  for (const auto* pair : pairs_)
    add_control_rows(*pair, direction, entries);
  const auto& mesh = layout_.mesh();
  for (PetscInt local = 0; local < layout_.num_owned(); ++local) {
    const auto node = static_cast<std::int32_t>(local / dim_);
    const bool is_control = node < mesh.num_owned && facet_totals_[node] > 0.0 && !mesh.is_vertex[node] &&
                            hold(node, static_cast<int>(local % dim_)) == Hold::Free;
    if (!is_control) entries.add(layout_.first_equation() + local, layout_.first_equation() + local, 1.0);
  }
  return assemble(entries);
}

void MortarTransform::build() {
  frames_.clear();
  for (const auto* pair : pairs_) {
    auto& frames = frames_.emplace_back();
    for (std::size_t i = 0; i < pair->nodes().nodes.size(); ++i)
      frames.push_back(frame(*pair, i));
  }
  auto turn = reflections();
  auto couple = couplings();
  inverse_ = product(turn, couple);
  if (layout_.mesh().order == 2) {
    AMT_PETSC(MatAYPX(inverse_, -1.0, product(turn, control_change(Direction::ToControls)), DIFFERENT_NONZERO_PATTERN));
    const auto nodes = control_change(Direction::ToNodes);
    turn = product(nodes, turn);
    couple = product(nodes, couple);
  } else {
    AMT_PETSC(MatAYPX(inverse_, -1.0, turn, DIFFERENT_NONZERO_PATTERN));
  }
  transform_ = MatHandle();
  AMT_PETSC(MatDuplicate(turn, MAT_COPY_VALUES, transform_.put()));
  auto next = product(couple, turn);
  double size = 0.0;
  AMT_PETSC(MatNorm(next, NORM_FROBENIUS, &size));
  for (std::size_t level = 0; size > 0.0; ++level) {
    if (level > pairs_.size())
      throw UserError("the contact pairs with " + enforce_text(*pairs_.front()) +
                      " form a ring: a slave node follows a master that in the "
                      "end follows the slave. Exchange slave and master of one of the pairs, or use `enforce: "
                      "{semismooth: {}}`.");
    AMT_PETSC(MatAXPY(transform_, 1.0, next, DIFFERENT_NONZERO_PATTERN));
    next = product(couple, next);
    AMT_PETSC(MatNorm(next, NORM_FROBENIUS, &size));
  }
  set_bounds();
}

void MortarTransform::set_bounds() {
  lower_ = layout_.new_vector();
  AMT_PETSC(VecSet(lower_, PETSC_NINFINITY));
  VecArray values(lower_);
  for (std::size_t p = 0; p < pairs_.size(); ++p)
    for (std::size_t i = 0; i < frames_[p].size(); ++i) {
      const auto node = pairs_[p]->nodes().nodes[i];
      const auto& frame = frames_[p][i];
      const auto& constraint = pairs_[p]->constraints()[i];
      if (frame.bounded && node < layout_.mesh().num_owned)
        values[PetscInt(node) * dim_ + frame.host] = -constraint.gap / (constraint.leverage() * frame.length);
    }
}

/// Work: f δû_h = λ ∫ ψ δgap = λ D |ñ| δû_h.
void MortarTransform::hold_forces(Vec forces) {
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    auto& pair = *pairs_[p];
    const NodeSpace space(layout_.mesh(), {pair.nodes()});
    std::vector<std::vector<double>> multipliers(1, std::vector<double>(frames_[p].size(), 0.0));
    {
      VecReader values(forces);
      for (std::size_t i = 0; i < frames_[p].size(); ++i) {
        const auto node = pair.nodes().nodes[i];
        const auto& frame = frames_[p][i];
        if (frame.bounded && node < layout_.mesh().num_owned)
          multipliers[0][i] =
              -values[PetscInt(node) * dim_ + frame.host] / (pair.constraints()[i].weight * frame.length);
      }
    }
    const auto global = space.new_vector();
    space.add(multipliers, global);
    space.gather(global, multipliers);
    pair.hold_multipliers(std::move(multipliers[0]));
  }
}

void MortarTransform::release() {
  for (auto* pair : pairs_)
    pair->release();
}

} // namespace amontons
