// Forms whose trouble for Newton's method is known on paper. All of them act on each node by itself, so they are the
// same problem on any number of ranks.
#pragma once

#include "form/problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

namespace amontons::test {

/// f(u) for every displacement component by itself, with its derivative.
class Scalar : public Form {
 public:
  using Function = std::function<double(double)>;
  Scalar(const DofLayout& layout, Function force, Function slope)
      : layout_(layout), force_(std::move(force)), slope_(std::move(slope)) {}
  const char* name() const override { return "scalar"; }
  void couple(Coupling& coupling) const override {
    std::vector<PetscInt> equations(layout_.dim());
    for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node) {
      for (int c = 0; c < layout_.dim(); ++c)
        equations[c] = layout_.equation(node, c);
      coupling.add(equations);
    }
  }
  void add_residual(const State& state, Residual& residual) override {
    for (std::int32_t i = 0; i < layout_.mesh().num_owned * layout_.dim(); ++i)
      residual.nodal()[i] += force_(state.displacement[i]);
  }
  void add_tangent(const State& state, Tangent& tangent) override {
    for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node)
      for (int c = 0; c < layout_.dim(); ++c) {
        const PetscInt equation = layout_.equation(node, c);
        const double value = slope_(state.displacement[std::size_t(node) * layout_.dim() + c]);
        tangent.add({&equation, 1}, {&value, 1});
      }
  }

 private:
  const DofLayout& layout_;
  Function force_, slope_;
};

/// u − g(u) = 0 for every displacement component by itself, g being a limit that depends on what it limits, as that of
/// friction does: u is carried up to the limit.
class SelfLimited : public Form, public Switching {
 public:
  using Function = std::function<double(double)>;
  SelfLimited(const DofLayout& layout, Function limit, Function slope)
      : layout_(layout), limit_(std::move(limit)), slope_(std::move(slope)),
        last_(std::size_t(layout.mesh().num_owned) * layout.dim(), 0.0) {}

  const char* name() const override { return "self-limited"; }
  bool tangent_is_symmetric() const override { return false; }
  void couple(Coupling& coupling) const override {
    for (std::size_t i = 0; i < last_.size(); ++i) {
      const PetscInt equation = equation_of(i);
      coupling.add({&equation, 1});
    }
  }
  void add_residual(const State& state, Residual& residual) override {
    for (std::size_t i = 0; i < last_.size(); ++i) {
      last_[i] = held_.empty() ? limit_(state.displacement[i]) : held_[i];
      residual.nodal()[i] += state.displacement[i] - last_[i];
    }
  }
  void add_tangent(const State& state, Tangent& tangent) override {
    for (std::size_t i = 0; i < last_.size(); ++i) {
      const PetscInt equation = equation_of(i);
      const double value = held_.empty() ? 1.0 - slope_(state.displacement[i]) : 1.0;
      tangent.add({&equation, 1}, {&value, 1});
    }
  }

  Switching* switching() override { return this; }
  const std::string& switch_name() const override { return name_; }
  std::array<double, 3> switch_place(std::size_t) const override { return {}; }
  std::vector<std::uint8_t> branches() const override { return {}; }
  void hold(std::vector<Hold>) override {}
  std::vector<std::uint8_t> wanted() const override { return {}; }
  bool has_limits() const override { return true; }
  void hold_limits() override { held_ = last_; }
  void release_limits() override { held_.clear(); }
  void scale_augmentation(double) override {}

 private:
  PetscInt equation_of(std::size_t i) const {
    return layout_.equation(static_cast<std::int32_t>(i) / layout_.dim(), static_cast<int>(i) % layout_.dim());
  }
  const DofLayout& layout_;
  Function limit_, slope_;
  std::vector<double> last_, held_;
  std::string name_ = "limits";
};

/// Every displacement component of this rank's nodes is a point that is on or off, without limits and augmentation.
class SwitchedComponents : public Switching {
 public:
  SwitchedComponents(const DofLayout& layout, std::string name)
      : layout_(layout), name_(std::move(name)), on_(std::size_t(layout.mesh().num_owned) * layout.dim(), 0),
        wanted_(on_) {}

  const std::string& switch_name() const override { return name_; }
  std::array<double, 3> switch_place(std::size_t i) const override {
    std::array<double, 3> place{};
    std::ranges::copy(layout_.mesh().position(static_cast<std::int32_t>(i) / layout_.dim()), place.begin());
    place[0] += 1e-3 * static_cast<double>(i % layout_.dim()); // the components one after another
    return place;
  }
  std::vector<std::uint8_t> branches() const override { return on_; }
  void hold(std::vector<Hold> holds) override { holds_ = std::move(holds); }
  std::vector<std::uint8_t> wanted() const override { return wanted_; }
  bool has_limits() const override { return false; }
  void hold_limits() override {}
  void release_limits() override {}
  void scale_augmentation(double) override {}

 protected:
  std::size_t num_components() const { return on_.size(); }
  bool is_on(std::size_t i) const { return on_[i] != 0; }
  /// As wanted unless held; returns what it is then.
  bool turn(std::size_t i, bool wanted) {
    wanted_[i] = wanted;
    on_[i] = holds_.empty() || holds_[i] == Hold::Free ? wanted : holds_[i] == Hold::On;
    return is_on(i);
  }

 private:
  const DofLayout& layout_;
  std::string name_;
  std::vector<std::uint8_t> on_, wanted_;
  std::vector<Hold> holds_;
};

/// Two or three complementary pairs at each node, z the displacement: F_i = min(z_i, w_i), w = M z + q. Component i is
/// on where z_i > w_i: then F_i = w_i.
class Complementarity : public Form, public SwitchedComponents {
 public:
  using Matrix = std::vector<std::vector<double>>;
  Complementarity(const DofLayout& layout, Matrix matrix, std::vector<double> q)
      : SwitchedComponents(layout, "pairs"), layout_(layout), matrix_(std::move(matrix)), q_(std::move(q)) {}

  const char* name() const override { return "complementarity"; }
  bool tangent_is_symmetric() const override { return false; }
  void couple(Coupling& coupling) const override {
    for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node)
      coupling.add(equations(node));
  }
  void add_residual(const State& state, Residual& residual) override {
    const int d = layout_.dim();
    for (std::size_t i = 0; i < num_components(); ++i) {
      const double z = state.displacement[i];
      double w = q_[i % d];
      for (int c = 0; c < d; ++c)
        w += matrix_[i % d][c] * state.displacement[i / d * d + c];
      residual.nodal()[i] += turn(i, z > w) ? w : z;
    }
  }
  void add_tangent(const State&, Tangent& tangent) override {
    const int d = layout_.dim();
    std::vector<double> block(std::size_t(d) * d);
    for (std::int32_t node = 0; node < layout_.mesh().num_owned; ++node) {
      for (int r = 0; r < d; ++r)
        for (int c = 0; c < d; ++c)
          block[r * d + c] = is_on(std::size_t(node) * d + r) ? matrix_[r][c] : (r == c ? 1.0 : 0.0);
      tangent.add(equations(node), block);
    }
  }

  Switching* switching() override { return this; }

 private:
  std::vector<PetscInt> equations(std::int32_t node) const {
    std::vector<PetscInt> equations;
    for (int c = 0; c < layout_.dim(); ++c)
      equations.push_back(layout_.equation(node, c));
    return equations;
  }

  const DofLayout& layout_;
  Matrix matrix_;
  std::vector<double> q_;
};

} // namespace amontons::test
