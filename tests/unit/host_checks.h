// A small host for the tests of filters: it runs them by name and looks at meshes as a host does.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "devseg/declare/filter.h"

namespace devseg::checks {

declare::HostResult run(const std::string& menu_name, const declare::HostMesh& host,
                        const declare::ParameterValues& values = {});
double value(const declare::HostResult& result, const std::string& name);
/// Of the measures of charts: disks, and those with flat holes.
double sound_charts(const declare::HostResult& measures);
double number(const declare::ParameterValue& value);

declare::HostMesh host_of(const mesh::RawMesh& raw);
void take_charts(declare::HostMesh& host, const declare::HostResult& result);

/// The host's mesh with its faces split as the result says.
mesh::RawMesh refined(mesh::RawMesh raw, const declare::HostResult& result);

/// All (face, edge) at each edge, by the host's vertices.
using Edges = std::map<std::set<Index>, std::vector<std::pair<std::size_t, int>>>;
Edges edges_of(const mesh::RawMesh& raw);

/// On every inner edge both faces agree about the seam, which lies between any two charts.
void expect_agreement(const mesh::RawMesh& raw, const declare::HostResult& result);

/// Every seam of the host is one of the result, on the same edge, whatever was split beside it.
void expect_kept_seams(const declare::HostMesh& host, const declare::HostResult& result);

double signed_area(const std::array<Vec2, 3>& triangle);
double area_on_surface(const mesh::RawMesh& raw, std::size_t face);

} // namespace devseg::checks
