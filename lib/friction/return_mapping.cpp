#include "friction/return_mapping.hpp"

#include "friction/slip_solver.hpp"

#include <algorithm>
#include <cmath>

namespace amontons {
namespace {

/// ε / (ε + τ_s): the share of a change of |q| that goes into slip.
double slip_share(double epsilon, double dtau_ds) { return epsilon / std::max(epsilon + dtau_ds, 1e-8 * epsilon); }

void set_isotropic(TangentMatrix& matrix, double value) {
  for (std::size_t i = 0; i < 3; ++i)
    matrix[i][i] = value;
}

} // namespace

std::array<double, 3> slip_vector(const FrictionResponse& response) {
  const double size = std::hypot(response.traction[0], response.traction[1], response.traction[2]);
  const double factor = size > 0.0 ? response.slip / size : 0.0;
  return {factor * response.traction[0], factor * response.traction[1], factor * response.traction[2]};
}

FrictionResponse return_map(const FrictionLaw& law, const FrictionContext& context, const TangentVector& q, double p,
                            double epsilon, const FrictionState& state_old) {
  const double r = std::hypot(q[0], q[1], q[2]);
  const auto solution = solve_slip({law, context, p, r, epsilon, state_old});
  const auto& limit = solution.limit;
  const double share = slip_share(epsilon, limit.dtau_ds);
  FrictionResponse response{.slip = solution.s,
                            .tau_c = limit.tau,
                            .status = solution.s > 0 ? FrictionStatus::Slip : FrictionStatus::Stick,
                            .is_several = solution.is_several,
                            .state = limit.state};
  if (response.status == FrictionStatus::Stick) {
    response.traction = q;
    set_isotropic(response.dtraction_dq, limit.tau > 0 ? 1.0 : 1.0 - share); // limit 0: q = 0, the border of slip
    return response;
  }
  const TangentVector n{q[0] / r, q[1] / r, q[2] / r};
  const double across = limit.tau / r, along = 1.0 - share;
  for (std::size_t i = 0; i < 3; ++i) {
    response.traction[i] = limit.tau * n[i];
    response.dtraction_dp[i] = limit.dtau_dp * share * n[i];
    for (std::size_t j = 0; j < 3; ++j)
      response.dtraction_dq[i][j] = (along - across) * n[i] * n[j] + (i == j ? across : 0.0);
  }
  return response;
}

FrictionResponse guess_response(const FrictionLaw& law, const FrictionContext& context, const TangentVector& q,
                                double p, double epsilon, const FrictionState& state_old, double slip) {
  const double size = std::hypot(q[0], q[1], q[2]);
  if (slip > 0.0 && size > 0.0) {
    const double factor = 1.0 + epsilon * slip / size;
    return return_map(law, context, {factor * q[0], factor * q[1], factor * q[2]}, p, epsilon, state_old);
  }
  FrictionResponse stick{.traction = q};
  set_isotropic(stick.dtraction_dq, 1.0);
  return stick;
}

} // namespace amontons
