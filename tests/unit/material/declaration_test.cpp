// Materials as a deck writes them: every tag, defaults, ranges, keys of another material; which law each becomes.
#include "../deck/read.hpp"
#include "material/bulk_material.hpp"

#include <doctest/doctest.h>

using namespace amontons;

TEST_CASE("each tag gives its material with its parameters") {
  const auto rule = bulk_material_rule();
  const auto elastic = std::get<Elastic>(read_well("{elastic: {E: 210e3, nu: 0.3}}", rule));
  CHECK(elastic.young == 210e3);
  CHECK(elastic.poisson == 0.3);
  CHECK(std::get<NeoHookean>(read_well("{neo_hookean: {E: 10, nu: 0.4999}}", rule)).elastic.poisson == 0.4999);
  CHECK(std::get<StVenantKirchhoff>(read_well("{st_venant_kirchhoff: {E: 10, nu: 0.2}}", rule)).elastic.young == 10);
  const auto rubber = std::get<MooneyRivlin>(read_well("{mooney_rivlin: {C10: 0.3, C01: 0.1, K: 400}}", rule));
  CHECK(rubber.C_10 == 0.3);
  CHECK(rubber.C_01 == 0.1);
  CHECK(rubber.K == 400);
  CHECK(std::get<MooneyRivlin>(read_well("{mooney_rivlin: {C10: 0.3, K: 400}}", rule)).C_01 == 0);

  const auto sheet = std::get<ElasticPlastic>(
      read_well("{elastic_plastic: {E: 206e3, nu: 0.3, hardening: {swift: {K: 567, eps_0: 0.007, n: 0.26}}, "
                "kinematic: {prager: {H: 500}}, rate: {perzyna: {D: 40, n: 5}}}}",
                rule));
  CHECK(sheet.elastic.young == 206e3);
  CHECK(std::get<SwiftHardening>(sheet.hardening).eps_0 == 0.007);
  CHECK(kinematic_modulus(sheet) == 500);
  CHECK(std::get<Perzyna>(*sheet.rate).n == 5);
  const auto plain = std::get<ElasticPlastic>(
      read_well("{elastic_plastic: {E: 70e3, nu: 0.3, hardening: {linear: {yield: 200}}}}", rule));
  CHECK(std::get<LinearHardening>(plain.hardening).H == 0);
  CHECK(!plain.kinematic);
  CHECK(!plain.rate);
  const auto hardening = hardening_rule();
  CHECK(std::get<VoceHardening>(read_well("{voce: {yield: 450, Q: 265, b: 16.93, H: 129}}", hardening)).H == 129);
  const auto table = std::get<TabulatedHardening>(
      read_well("{table: {plastic_strain: [0, 0.1], yield_stress: [200, 300]}}", hardening));
  CHECK(table.plastic_strain == std::vector<double>{0, 0.1});
  CHECK(table.yield_stress == std::vector<double>{200, 300});
}

TEST_CASE("wrong parameters are refused at their place") {
  const auto rule = bulk_material_rule();
  check_refused("{elastic: {E: -1, nu: 0.3}}", rule, "f:1:15: ", "> 0");
  check_refused("{neo_hookean: {E: 1, nu: 0.5}}", rule, "f:1:26: ", "< 0.5");
  check_refused("{neo_hooke: {E: 1, nu: 0.3}}", rule, "f:1:2: ", "neo_hookean");
  check_refused("{mooney_rivlin: {C10: 1, C01: -1, K: 5}}", rule, "f:1:31: ", ">= 0");
  check_refused("{elastic: {E: 1, nu: 0.3, hardening: {linear: {yield: 1}}}}", rule, "f:1:27: ", "elastic_plastic");
  check_refused("{elastic_plastic: {E: 1, nu: 0.3}}", rule, "f:1:19: ", "hardening");
  check_refused("{elastic_plastic: {E: 1, nu: 0.3, hardening: {linear: {yield: 1}}, rate: {perzyna: {D: 1, n: 0.5}}}}",
                rule, "f:1:94: ", ">= 1");
  const auto hardening = hardening_rule();
  check_refused("{linear: {yield: 0}}", hardening, "f:1:18: ", "> 0");
  check_refused("{linear: {yield: 1, H: -5}}", hardening, "f:1:24: ", ">= 0");
  check_refused("{swift: {K: 1, eps_0: 0, n: 0.2}}", hardening, "f:1:23: ", "> 0");
  check_refused("{table: {plastic_strain: [0, 0.1], yield_stress: [1]}}", hardening, "f:1:9: ", "as many");
  check_refused("{table: {plastic_strain: [0.1], yield_stress: [1]}}", hardening, "f:1:9: ", "0 first");
  check_refused("{table: {plastic_strain: [0, 0], yield_stress: [1, 2]}}", hardening, "f:1:9: ", "increasing");
  check_refused("{table: {plastic_strain: [0, 1], yield_stress: [2, 1]}}", hardening, "f:1:9: ", "never falls");
}

TEST_CASE("small kinematics refuse the materials of large strain with the way out; finite ones take all") {
  CHECK(std::holds_alternative<Elastic>(small_law(Elastic{1, 0.3}, "block")));
  CHECK(std::holds_alternative<SmallPlastic>(small_law(ElasticPlastic{}, "block")));
  CHECK_THROWS_WITH_AS(small_law(NeoHookean{}, "materials.rubber"),
                       doctest::Contains("materials.rubber is a law of large strain"), UserError);
  CHECK_THROWS_WITH_AS(small_law(MooneyRivlin{}, "rubber"), doctest::Contains("kinematics: finite"), UserError);
  CHECK(std::holds_alternative<Hencky>(finite_law(Elastic{1, 0.3})));
  CHECK(std::holds_alternative<FinitePlastic>(finite_law(ElasticPlastic{})));
  CHECK(std::holds_alternative<NeoHookean>(finite_law(NeoHookean{})));
}
