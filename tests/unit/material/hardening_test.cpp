// Hardening laws: values in closed form, slope and work as derivative and integral of the stress.
#include "material/hardening.hpp"

#include <cmath>
#include <doctest/doctest.h>

using namespace amontons;
using doctest::Approx;

TEST_CASE("values of each law") {
  CHECK(yield_stress(LinearHardening{250, 1000}, 0.1) == Approx(350));
  CHECK(yield_stress(SwiftHardening{500, 0.01, 0.5}, 0) == Approx(50));
  CHECK(yield_stress(SwiftHardening{500, 0.01, 0.5}, 0.35) == Approx(300));
  CHECK(yield_stress(VoceHardening{450, 265, 16.93, 129.24}, 0) == Approx(450));
  CHECK(yield_stress(VoceHardening{450, 265, 16.93, 0}, 10) == Approx(715));
  CHECK(yield_stress(VoceHardening{450, 265, std::log(2.0), 100}, 1) == Approx(450 + 132.5 + 100));
  const TabulatedHardening table{{0, 0.1, 0.3}, {200, 300, 350}};
  CHECK(yield_stress(table, 0) == 200);
  CHECK(yield_stress(table, 0.05) == Approx(250));
  CHECK(yield_stress(table, 0.1) == Approx(300));
  CHECK(yield_stress(table, 0.2) == Approx(325));
  CHECK(yield_stress(table, 0.3) == Approx(350));
  CHECK(yield_stress(table, 5) == 350);
  CHECK(hardening_slope(table, 5) == 0);
  CHECK(hardening_slope(table, 0.1) == Approx(250));
  CHECK(yield_stress(TabulatedHardening{{0}, {200}}, 0.5) == 200);
}

TEST_CASE("slope is the derivative and work the integral of the yield stress") {
  const Hardening laws[] = {LinearHardening{250, 1000}, SwiftHardening{500, 0.01, 0.3}, SwiftHardening{500, 0.01, 0},
                            VoceHardening{450, 265, 16.93, 129.24}, TabulatedHardening{{0, 0.1, 0.3}, {200, 300, 350}}};
  for (const auto& law : laws) {
    CAPTURE(law.index());
    for (const double p : {0.003, 0.05, 0.17, 0.29, 0.8}) {
      const double h = 1e-6;
      const double slope = (yield_stress(law, p + h) - yield_stress(law, p - h)) / (2 * h);
      CHECK(std::abs(hardening_slope(law, p) - slope) < 1e-5 * (1 + slope));
    }
    for (const double from : {0.0, 0.05, 0.1, 0.31}) {
      const double to = from + 0.37;
      double sum = 0;
      constexpr int n = 20000;
      for (int i = 0; i < n; ++i)
        sum += yield_stress(law, from + (i + 0.5) * (to - from) / n) * (to - from) / n;
      CHECK(hardening_work(law, from, to) == Approx(sum).epsilon(1e-7));
      CHECK(hardening_work(law, from, from) == 0);
      CHECK(hardening_work(law, from, from + 1e-9) == Approx(1e-9 * yield_stress(law, from)).epsilon(1e-5));
    }
  }
}
