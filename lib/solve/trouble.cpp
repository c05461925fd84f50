#include "solve/trouble.hpp"

#include "base/log.hpp"

#include <map>

namespace amontons {

namespace {

std::string free_bodies(const std::vector<FreeMotion>& free) {
  std::map<std::string, std::string> directions; // by body
  for (const auto& motion : free) {
    auto& text = directions[motion.body];
    text += (text.empty() ? "" : ", ") + motion.direction;
  }
  std::string text;
  constexpr std::size_t most = 4;
  std::size_t named = 0;
  for (const auto& [body, where] : directions) {
    if (named++ == most) {
      text += formatted(" and %zu more bodies", directions.size() - most);
      break;
    }
    text += (text.empty() ? "'" : "; '") + body + "' " + where;
  }
  return text;
}

std::string flipping_points(const Trouble& trouble) {
  std::string text = formatted("%lld point%s", static_cast<long long>(trouble.num_flipping),
                               trouble.num_flipping == 1 ? " flips" : "s flip");
  for (const auto& point : trouble.points)
    text += formatted("%s '%s' at (%.6g, %.6g, %.6g)", &point == &trouble.points.front() ? ":" : ",",
                      point.name.c_str(), point.place[0], point.place[1], point.place[2]);
  return text + (trouble.num_flipping > static_cast<std::int64_t>(trouble.points.size()) ? ", ..." : "");
}

} // namespace

std::string in_words(const Trouble& trouble) {
  std::string text = trouble.solver;
  const auto say = [&text](const std::string& more) { text += "; " + more; };
  if (trouble.cycle > 0)
    say(formatted("the contact status goes round in a cycle of %d iterations at %.1e of the forces in play",
                  trouble.cycle, trouble.residual));
  if (trouble.rests)
    say(formatted("the contact status rests, but the out-of-balance force stays at %.1e of the forces in play: with "
                  "this status there is no equilibrium",
                  trouble.residual));
  if (trouble.num_flipping > 0) say(flipping_points(trouble));
  if (trouble.largest_change > too_many_at_once)
    say(formatted("up to %.0f %% of the contact points changed their status in one iteration: the increment may be too "
                  "large",
                  100.0 * trouble.largest_change));
  if (!trouble.free.empty())
    say("in the last iterate nothing holds " + free_bodies(trouble.free) +
        ": a load that contact and supports cannot bear, or a missing support or contact pair");
  return text;
}

} // namespace amontons
