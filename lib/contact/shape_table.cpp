#include "contact/shape_table.hpp"

#include "math/reference_element.hpp"

#include <array>

namespace amontons {

ShapeTable shape_table(ElementType type, std::span<const double> xi) {
  const int n = num_nodes(type), d = element_dim(type);
  std::array<double, 9> values{};
  std::array<double, 18> gradients{};
  std::array<double, 36> hessians{};
  const auto place = xi.first(d);
  shape_values(type, place, std::span(values).first(n));
  shape_gradients(type, place, std::span(gradients).first(n * d));
  shape_hessians(type, place, std::span(hessians).first(n * d * d));
  ShapeTable table = ShapeTable::Zero(6, n);
  for (int a = 0; a < n; ++a) {
    table(0, a) = values[a];
    for (int i = 0; i < d; ++i) {
      table(1 + i, a) = gradients[a * d + i];
      for (int j = i; j < d; ++j)
        table(3 + i + j, a) = hessians[(a * d + i) * d + j];
    }
  }
  return table;
}

} // namespace amontons
