// As in tangential_part.cpp a point slides over a fixed place of the master, and one that was open starts anew; but the
// motion is that of a node, weighted with its dual function, and its multiplier λ_t is all the traction there is: with
//   q = λ_t + ε Δg_t,  λ_t = return_map(q, p = −λ_n)
// a node that sticks has Δg_t = 0 exactly and one that slides has slipped by Δg_t. ε has no influence on the solution.
#include "contact/nodal_friction.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {

namespace {

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

} // namespace

NodalFriction::NodalFriction(const DofLayout& layout, const ContactPair& pair, const NodeField& nodes,
                             const std::array<double, 3>& shift)
    : layout_(layout), pair_(pair), nodes_(nodes), factor_(nodes.nodes.size(), 1.0), history_(nodes.nodes.size()),
      responses_(nodes.nodes.size()), jump_(nodes.nodes.size()), closed_(nodes.nodes.size(), 0) {
  for (auto& node : history_)
    for (int c = 0; c < 3; ++c)
      node.jump[c] = -shift[c];
}

void NodalFriction::move_to(double time) {
  time_ = time;
  if (!pair_.friction->factor || time == factor_time_) return;
  factor_time_ = time;
  together(layout_.mesh().comm, [&] {
    for (std::size_t i = 0; i < factor_.size(); ++i) {
      factor_[i] = (*pair_.friction->factor)(time, layout_.mesh().position(nodes_.nodes[i]));
      if (!(factor_[i] >= 0.0))
        throw UserError("contact: friction_factor of the pair '" + pair_.name +
                        "' is negative or not a number at t = " + std::to_string(time) +
                        ". Make it an expression that is never below zero.");
    }
  });
}

FrictionContext NodalFriction::context(std::size_t i) const {
  return {.dt = std::max(0.0, time_ - accepted_time_), .factor = factor_[i], .new_contact = history_[i].open};
}

FrictionResponse NodalFriction::respond(std::size_t i, const TangentVector& q, double p, double epsilon) const {
  return return_map(pair_.friction->law, context(i), q, p, epsilon, history_[i].state);
}

FrictionResponse NodalFriction::guess(std::size_t i, const TangentVector& q, double p, double epsilon) const {
  const auto now = context(i);
  return guess_response(pair_.friction->law, now, q, p, epsilon, history_[i].state, history_[i].slip_rate * now.dt);
}

std::array<double, 3> NodalFriction::motion(std::size_t i, const std::array<double, 3>& jump) const {
  const auto& old = history_[i].jump;
  return {jump[0] - old[0], jump[1] - old[1], jump[2] - old[2]};
}

void NodalFriction::hold(const Claim& claim, std::span<const double> normal, std::span<const double> epsilon) {
  jump_ = claim.jump;
  for (std::size_t i = 0; i < responses_.size(); ++i) {
    closed_[i] = normal[i] < 0.0;
    responses_[i] = closed_[i] ? respond(i, claim.trial[i], -normal[i], epsilon[i]) : FrictionResponse{};
  }
}

void NodalFriction::release() {
  std::fill(responses_.begin(), responses_.end(), FrictionResponse{});
  std::fill(closed_.begin(), closed_.end(), std::uint8_t{0});
}

ContactStatus NodalFriction::status(std::size_t i) const {
  if (!closed_[i]) return ContactStatus::Open;
  return responses_[i].status == FrictionStatus::Slip ? ContactStatus::Slip : ContactStatus::Stick;
}

void NodalFriction::commit(double time) {
  const double duration = time - accepted_time_;
  for (std::size_t i = 0; i < history_.size(); ++i)
    history_[i] = {.traction = responses_[i].traction,
                   .jump = jump_[i],
                   .state = responses_[i].state,
                   .slip = history_[i].slip + responses_[i].slip,
                   .slip_rate = duration > 0.0 ? responses_[i].slip / duration : 0.0,
                   .open = closed_[i] == 0};
  accepted_time_ = time;
}

void NodalFriction::roll_back() {
  forget_course(); // going on like that has failed
  resume();
}

void NodalFriction::forget_course() {
  for (auto& node : history_)
    node.slip_rate = 0.0;
}

void NodalFriction::resume() {
  for (std::size_t i = 0; i < history_.size(); ++i) {
    responses_[i] = {.traction = history_[i].traction};
    closed_[i] = !history_[i].open;
    jump_[i] = history_[i].jump;
  }
}

void NodalFriction::save(ContactHistory& history) const {
  history.time = accepted_time_;
  history.nodes = history_;
}

void NodalFriction::restore(const ContactHistory& history) {
  accepted_time_ = history.time;
  history_ = history.nodes;
  resume();
}

/// Nothing is stored: a node that sticks does not move.
void NodalFriction::add_to(std::size_t i, double area, const std::array<double, 3>& shift, TangentialSums& sums) const {
  if (status(i) == ContactStatus::Stick) sums.stick_area += area;
  if (status(i) == ContactStatus::Slip) sums.slip_area += area;
  const auto& traction = responses_[i].traction;
  const auto moved = motion(i, jump_[i]);
  const double dissipation = dot(traction, slip_vector(responses_[i]));
  const double at_end = dot(traction, moved), at_start = dot(history_[i].traction, moved);
  sums.dissipation += area * dissipation;
  sums.work += area * (dot(traction, jump_[i]) + dot(traction, shift));
  sums.mismatch += area * (0.5 * (at_end + at_start) - dissipation);
  sums.change += area * 0.5 * std::abs(at_end - at_start);
}

void NodalFriction::sample(std::size_t i, ContactSamples& samples) const {
  const auto& response = responses_[i];
  samples.shear.push_back({-response.traction[0], -response.traction[1], -response.traction[2]});
  samples.tau_c.push_back(response.tau_c);
  samples.slip.push_back(slip_vector(response));
  samples.accumulated_slip.push_back(history_[i].slip + response.slip);
  samples.friction_context.push_back(context(i));
  samples.friction_state_old.push_back(history_[i].state);
  for (std::size_t k = 0; k < samples.states.size(); ++k)
    samples.states[k].push_back(response.state[k]);
}

} // namespace amontons
