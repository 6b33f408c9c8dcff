// Running many seeded cases, and what every case does with filters.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "devseg/declare/filter.h"
#include "property/random_mesh.h"

namespace devseg::checks {

/// Calls `check` for `usual` seeds, or for as many as DEVSEG_PROPERTY_CASES says, from seed 0 or
/// DEVSEG_PROPERTY_FIRST on; the seeds of failing cases are told. Gives up after ten of them.
void for_random_cases(int usual, const std::function<void(shapes::Random& random)>& check);

/// The filters whose names in the menu start so; all of the plugins for an empty text.
std::vector<const declare::FilterDeclaration*> filters_named(const std::string& start);
const declare::FilterDeclaration&
any_of(const std::vector<const declare::FilterDeclaration*>& filters, shapes::Random& random);

/// A value for each parameter: its default, an end of its range, or anything between. Files go to
/// `file_stem` with one of the extensions of patterns. What would only take long is left out.
declare::ParameterValues random_values(const declare::FilterDeclaration& filter, Index faces,
                                       const std::string& file_stem, shapes::Random& random);
std::string described(const declare::FilterDeclaration& filter,
                      const declare::ParameterValues& values);

/// Runs the filter. Errors that tell the user about mesh or parameters give nothing, if they are
/// `may_refuse`; all others, and more than a minute (DEVSEG_PROPERTY_SECONDS), are failures of the
/// test.
std::optional<declare::HostResult> attempt(const declare::FilterDeclaration& filter,
                                           const declare::HostMesh& host,
                                           const declare::ParameterValues& values, bool may_refuse);

/// Charts 0 … n − 1, each connected and sound: a disk, or one with flat holes; both sides of a seam
/// know of it. `weld`: the filter's, as it says which faces there are.
void expect_disks(const mesh::RawMesh& raw, const declare::HostResult& result, double weld = 0.0);
/// Finite, no face flipped or on another one; in the unit square if `packed`; and the suite's own
/// measures agree.
void expect_valid_layout(const mesh::RawMesh& raw, const declare::HostResult& result, bool packed);
/// Everything for all faces or absent; what is written on the mesh is finite, no result is NaN.
void expect_complete(const mesh::RawMesh& raw, const declare::HostResult& result);

} // namespace devseg::checks
