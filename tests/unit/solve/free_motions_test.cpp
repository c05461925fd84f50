// Bodies that nothing holds, found by their rigid motions: against what the supports leave free on paper.
#include "solve/free_motions.hpp"

#include "made_up_forms.hpp"
#include "two_blocks.hpp"

#include <algorithm>
#include <doctest/doctest.h>

using namespace amontons;
using namespace amontons::test;

namespace {

/// Springs between the nodes of each cell, along the axes and diagonals: stiff against every strain, not against rigid
/// motions.
class Truss : public Form {
 public:
  explicit Truss(const DofLayout& layout) : layout_(layout) {}
  const char* name() const override { return "truss"; }
  void couple(Coupling& coupling) const override {
    each_bar([&](const auto& equations, const auto&) { coupling.add(equations); });
  }
  void add_residual(const State&, Residual&) override {}
  void add_tangent(const State&, Tangent& tangent) override {
    const int d = layout_.dim();
    each_bar([&](const auto& equations, const auto& n) {
      std::vector<double> block(std::size_t(2 * d) * 2 * d);
      for (int r = 0; r < 2 * d; ++r)
        for (int c = 0; c < 2 * d; ++c)
          block[r * 2 * d + c] = (r / d == c / d ? 1.0 : -1.0) * n[r % d] * n[c % d];
      tangent.add(equations, block);
    });
  }

 private:
  template <class Work>
  void each_bar(Work&& work) const {
    const auto& mesh = layout_.mesh();
    const int d = layout_.dim();
    for (const auto& block : mesh.blocks)
      for (std::int32_t cell = 0; cell < block.size(); ++cell) {
        const auto nodes = block.cell(cell);
        for (std::size_t a = 0; a < nodes.size(); ++a)
          for (std::size_t b = a + 1; b < nodes.size(); ++b) {
            std::vector<PetscInt> equations;
            std::array<double, 3> n{};
            double length = 0.0;
            for (int c = 0; c < d; ++c) {
              n[c] = mesh.position(nodes[b])[c] - mesh.position(nodes[a])[c];
              length += n[c] * n[c];
            }
            for (double& component : n)
              component /= std::sqrt(length);
            for (const auto node : {nodes[a], nodes[b]})
              for (int c = 0; c < d; ++c)
                equations.push_back(layout_.equation(node, c));
            work(equations, n);
          }
      }
  }
  const DofLayout& layout_;
};

std::vector<std::string> free_motions(int dim, std::vector<PrescribedDisplacement> prescribed) {
  const auto mesh = two_blocks_mesh(PETSC_COMM_WORLD, dim, 2, 2, 0.5);
  const DofLayout layout(mesh, {}, {});
  std::vector<std::unique_ptr<Form>> forms;
  forms.push_back(std::make_unique<Truss>(layout));
  Problem problem(layout, std::move(forms), std::move(prescribed));
  const auto u = layout.new_vector();
  problem.begin_increment(1.0, u);
  const auto matrix = problem.new_matrix();
  problem.tangent(u, matrix);
  std::vector<std::string> found;
  for (const auto& motion : find_free_motions(problem, matrix))
    found.push_back(motion.body + " " + motion.direction);
  std::sort(found.begin(), found.end());
  return found;
}

Expression zero() { return {0.0}; }

using Names = std::vector<std::string>;

} // namespace

TEST_CASE("a free body has all its rigid motions, a clamped one none") {
  CHECK(free_motions(2, {{"bottom", 0, zero()}, {"bottom", 1, zero()}}) ==
        Names{"upper about z", "upper along x", "upper along y"});
  CHECK(free_motions(3, {{"bottom", 0, zero()}, {"bottom", 1, zero()}, {"bottom", 2, zero()}}) ==
        Names{"upper about x", "upper about y", "upper about z", "upper along x", "upper along y", "upper along z"});
}

TEST_CASE("supports in one direction leave the others") {
  const Names lower = {"lower along x"};
  CHECK(free_motions(2, {{"bottom", 1, zero()}, {"top", 0, zero()}, {"top", 1, zero()}}) == lower);
  // In 3D a floor holds z and the turning about x and y.
  CHECK(free_motions(3, {{"bottom", 2, zero()}, {"top", 0, zero()}, {"top", 1, zero()}, {"top", 2, zero()}}) ==
        Names{"lower about z", "lower along x", "lower along y"});
}
