// Materials as a deck names them, and the law that each is in small and in finite kinematics. The list below and the
// tags in bulk_material.cpp are the registry.
#pragma once

#include "material/finite_law.hpp"

namespace amontons {

using BulkMaterial = std::variant<Elastic, ElasticPlastic, StVenantKirchhoff, NeoHookean, MooneyRivlin>;

/// The law for small strain. Throws UserError, beginning with `name`, for the hyperelastic materials, which at small
/// strain are nothing but `elastic`.
SmallLaw small_law(const BulkMaterial& material, const std::string& name);

/// The law for finite strain; `elastic` becomes Hencky.
FiniteLaw finite_law(const BulkMaterial& material);

/// Young's modulus at zero strain, unit of stress, for scales.
double initial_stiffness(const BulkMaterial& material);

/// `{elastic: {E: 210e3, nu: 0.3}}` and so on: reads, checks and documents any material.
Rule<BulkMaterial> bulk_material_rule();

} // namespace amontons
