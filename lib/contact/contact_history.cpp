#include "contact/contact_history.hpp"

#include <algorithm>

namespace amontons {

void PointHistory::append_to(std::vector<double>& row) const {
  row.insert(row.end(), traction.begin(), traction.end());
  row.insert(row.end(), jump.begin(), jump.end());
  row.insert(row.end(), state.begin(), state.end());
  row.insert(row.end(), {slip, open ? 1.0 : 0.0, slip_rate});
}

PointHistory PointHistory::from_row(std::span<const double> row) {
  PointHistory point;
  std::copy_n(row.begin(), 3, point.traction.begin());
  std::copy_n(row.begin() + 3, 3, point.jump.begin());
  std::copy_n(row.begin() + 6, 2, point.state.begin());
  point.slip = row[8];
  point.open = row[9] != 0.0;
  point.slip_rate = row[10];
  return point;
}

} // namespace amontons
