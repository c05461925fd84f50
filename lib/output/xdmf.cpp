#include "output/xdmf.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <petscsys.h>
#include <sstream>

namespace amontons {

namespace {

const std::string step_mark = "<!-- step at time ";

std::string number(double value) {
  char digits[32];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
  return {digits, end};
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
    case '&':
      result += "&amp;";
      break;
    case '<':
      result += "&lt;";
      break;
    case '>':
      result += "&gt;";
      break;
    case '"':
      result += "&quot;";
      break;
    default:
      result += c;
    }
  }
  return result;
}

std::string data_item(const XdmfData& data) {
  std::string text = "<DataItem Format=\"HDF\" Dimensions=\"";
  text += std::to_string(data.rows);
  if (data.columns > 1) text += ' ' + std::to_string(data.columns);
  text += data.is_integer ? "\" NumberType=\"Int\" Precision=\"" : "\" NumberType=\"Float\" Precision=\"";
  text += std::to_string(data.is_integer ? sizeof(PetscInt) : sizeof(double));
  return text + "\">" + escaped(data.path) + "</DataItem>";
}

std::string topology(const XdmfGrid& grid) {
  const std::string count = "NumberOfElements=\"" + std::to_string(grid.num_cells) + "\"";
  const std::string type = grid.is_cloud ? "\"Polyvertex\" NodesPerElement=\"1\" " : "\"Mixed\" ";
  return "        <Topology TopologyType=" + type + count + ">" + data_item(grid.topology) + "</Topology>\n";
}

std::string grid_text(const XdmfGrid& grid) {
  std::string text = "      <Grid Name=\"" + escaped(grid.name) + "\">\n" + topology(grid);
  text += "        <Geometry GeometryType=\"XYZ\">" + data_item(grid.geometry) + "</Geometry>\n";
  for (const auto& attribute : grid.attributes)
    text += "        <Attribute Name=\"" + escaped(attribute.name) + "\" AttributeType=\"" + attribute.type +
            "\" Center=\"" + attribute.center + "\">" + data_item(attribute.data) + "</Attribute>\n";
  return text + "      </Grid>\n";
}

template <std::size_t n>
constexpr std::array<int, n> counted() {
  std::array<int, n> order{};
  for (std::size_t i = 0; i < n; ++i)
    order[i] = int(i);
  return order;
}

} // namespace

std::span<const int> xdmf_order(ElementType type) {
  static constexpr auto same = counted<9>();
  // gmsh lists the edges of a tetrahedron as 01 12 20 30 23 13, VTK as 01 12 20 03 13 23.
  static constexpr std::array tetrahedron = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
  // gmsh lists the edges of a hexahedron as 01 03 04 12 15 23 26 37 45 47 56 67, VTK as 01 12 23 30 45 56 67 74 04 15
  // 26 37.
  static constexpr std::array hexahedron = {0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15};
  if (type == ElementType::Tetrahedron10) return tetrahedron;
  if (type == ElementType::Hexahedron27) return hexahedron;
  return std::span(same).first(num_nodes(type));
}

std::span<const int> xdmf_announcement(ElementType type) {
  static constexpr std::array polyline_of_2 = {2, 2};
  static constexpr std::array codes = {2, 0x22, 4, 0x24, 5, 0x23, 6, 0x26, 9, 0x30}; // in the order of ElementType
  if (type == ElementType::Segment2) return polyline_of_2;
  return std::span(codes).subspan(static_cast<std::size_t>(type), 1);
}

std::string xdmf_head(const std::string& title) {
  return "<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"2.0\">\n"
         "<Domain>\n  <Grid Name=\"" +
         escaped(title) + "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
}

std::string xdmf_tail() { return "  </Grid>\n</Domain>\n</Xdmf>\n"; }

std::string xdmf_step(double time, const std::vector<XdmfGrid>& grids) {
  std::string text = step_mark + number(time) +
                     " -->\n    <Grid Name=\"step\" GridType=\"Collection\" CollectionType=\"Spatial\">\n"
                     "      <Time Value=\"" +
                     number(time) + "\"/>\n";
  for (const auto& grid : grids)
    text += grid_text(grid);
  return text + "    </Grid>\n";
}

XdmfSteps xdmf_steps_until(const std::string& file, double time) {
  const double last = time + 1e-9 * std::abs(time);
  XdmfSteps steps;
  const std::size_t end = file.rfind(xdmf_tail());
  for (std::size_t begin = file.find(step_mark); begin < end && end != std::string::npos;) {
    const std::size_t next = std::min(end, file.find(step_mark, begin + 1));
    double step_time = 0.0;
    std::from_chars(file.data() + begin + step_mark.size(), file.data() + next, step_time);
    if (step_time <= last) {
      steps.text += file.substr(begin, next - begin);
      ++steps.count;
    }
    begin = next;
  }
  return steps;
}

} // namespace amontons
