#include "property/cases.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <sstream>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "filters/export_filter.h"
#include "unit/checks.h"
#include "unit/host_checks.h"

namespace devseg::checks {

namespace {

using Clock = std::chrono::steady_clock;
using shapes::Random;

constexpr long longest_run = 60; // seconds
constexpr int busy = 5;          // times as long, where it has not had as many of a processor
constexpr int most_failures = 10;

long from_environment(const char* name, long otherwise) {
    const char* text = std::getenv(name);
    return text == nullptr ? otherwise : std::atol(text);
}

bool is_default(Random& random) {
    return random.below(5) < 2;
}

int random_integer(const declare::Parameter& parameter, Index faces, Random& random) {
    const double most = parameter.name == "max_iterations" ? 12.0 : std::max(2.0 * faces, 8.0);
    if (parameter.name == "random_seed")
        return random.below(1 << 30);
    const double low = parameter.minimum;
    const double high = std::min(parameter.maximum, std::max(low, most));
    // Small numbers are more interesting.
    const double share = std::pow(random.uniform(0.0, 1.0), 3.0);
    return static_cast<int>(std::floor(low + share * (high - low)));
}

double random_real(const declare::Parameter& parameter, Random& random) {
    switch (random.below(8)) {
    case 0:
        return parameter.minimum;
    case 1:
        return parameter.maximum;
    case 2:
        return random.uniform(parameter.minimum, parameter.maximum);
    default: // around the default
        const double usual = std::get<double>(parameter.default_value);
        const double value = (usual == 0.0 ? 1.0 : usual) * std::pow(10.0, random.uniform(-2., 2.));
        return std::clamp(value, parameter.minimum, parameter.maximum);
    }
}

std::string random_text(Random& random) {
    constexpr const char* texts[] = {"none", "a4",    "A3",     "letter",     "600x400", "50x5000",
                                     "",     "1x1",   "0x0",    "axb",        "1e3x1e2", "nanxinf",
                                     "x",    "-4x10", "210x 1", "99999x99999"};
    return texts[random.below(16)];
}

// Labels, seams and coordinates of the host's faces, as filters see them behind the gate.
struct Gated {
    mesh::GatedMesh gate;
    atlas::ChartMap charts;
    std::vector<std::array<Vec2, 3>> uv; // #F, corners in the order of the gated face
};

Gated behind_gate(const mesh::RawMesh& raw, const declare::HostResult& result, double weld) {
    Gated gated{mesh::gate_mesh(raw, {weld, false}), {}, {}};
    const mesh::GatedMesh& gate = gated.gate;
    for (const Face f : gate.mesh.all_faces()) {
        const std::size_t source = at(gate.source_face[f]);
        const Index chart = result.chart_id[source];
        gated.charts.chart.push_back(chart);
        gated.charts.count = std::max(gated.charts.count, chart + 1);
        std::array<Vec2, 3> corners{Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
        for (Index k = 0; k < 3; ++k) {
            const bool cut = (result.seam_edges[source] >> gate.source_edge(f, k) & 1) != 0;
            gated.charts.seam.push_back(cut && gate.mesh.twin[3 * f + k] >= 0 ? 1 : 0);
            if (!result.wedge_uv.empty())
                corners[k] = result.wedge_uv[source][gate.source_corner(f, k)];
        }
        if (!result.wedge_uv.empty())
            gated.uv.push_back(corners);
    }
    return gated;
}

Index flipped_faces(const std::vector<std::array<Vec2, 3>>& uv) {
    std::vector<Vec2> points;
    std::vector<Triangle> faces;
    for (const auto& corners : uv) {
        const auto first = static_cast<Index>(points.size());
        points.insert(points.end(), corners.begin(), corners.end());
        faces.push_back({first, first + 1, first + 2});
    }
    return count_flips(faces, points);
}

// Pairs of faces that share more than rounding, by clipping: independent of the suite's measures.
Index overlapping_pairs(const std::vector<std::array<Vec2, 3>>& uv, double extent) {
    std::vector<Eigen::AlignedBox2d> boxes;
    for (const auto& face : uv)
        boxes.push_back(Eigen::AlignedBox2d(face[0]).extend(face[1]).extend(face[2]));
    Index count = 0;
    for (std::size_t i = 0; i < uv.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            if (!boxes[i].intersects(boxes[j]))
                continue;
            const double least = std::min(std::abs(signed_area(uv[i])), //
                                          std::abs(signed_area(uv[j])));
            // 32-bit coordinates: what a corner moves by rounding, along a whole edge.
            const double rounding = 1e-7 * extent * (boxes[i].diagonal().norm() + 1e-3 * extent);
            count += common_area(uv[i], uv[j]) > 0.01 * least + rounding ? 1 : 0;
        }
    return count;
}

} // namespace

void for_random_cases(int usual, const std::function<void(Random& random)>& check) {
    const long first = from_environment("DEVSEG_PROPERTY_FIRST", 0);
    const long count = from_environment("DEVSEG_PROPERTY_CASES", usual);
    const bool told = from_environment("DEVSEG_PROPERTY_TRACE", 0) != 0;
    int failures = 0;
    for (long seed = first; seed < first + count && failures < most_failures; ++seed) {
        if (told)
            std::cerr << "case " << seed << std::endl; // a crash leaves the number behind
        const auto before =
            testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count();
        SCOPED_TRACE("DEVSEG_PROPERTY_FIRST=" + std::to_string(seed));
        Random random(static_cast<std::uint32_t>(seed));
        check(random);
        const auto after =
            testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count();
        failures += after > before ? 1 : 0;
    }
}

std::vector<const declare::FilterDeclaration*> filters_named(const std::string& start) {
    std::vector<const declare::FilterDeclaration*> found;
    for (const declare::FilterDeclaration& filter : exporting::plugin_filters())
        if (filter.menu_name.compare(0, start.size(), start) == 0)
            found.push_back(&filter);
    return found;
}

const declare::FilterDeclaration&
any_of(const std::vector<const declare::FilterDeclaration*>& filters, Random& random) {
    return *filters[random.below(static_cast<Index>(filters.size()))];
}

declare::ParameterValues random_values(const declare::FilterDeclaration& filter, Index faces,
                                       const std::string& file_stem, Random& random) {
    declare::ParameterValues values;
    constexpr const char* extensions[] = {".svg", ".pdf", ".dxf"};
    for (const declare::Parameter& parameter : filter.parameters) {
        if (parameter.kind == declare::ParameterKind::output_file) {
            values[parameter.name] = file_stem + extensions[random.below(3)];
            continue;
        }
        if (is_default(random)) {
            // Filters refuse more charts than faces.
            if (parameter.name == "charts_number")
                values[parameter.name] =
                    std::min(std::get<int>(parameter.default_value), std::max(faces, 1));
            continue;
        }
        switch (parameter.kind) {
        case declare::ParameterKind::boolean:
            values[parameter.name] = random.below(2) == 1;
            break;
        case declare::ParameterKind::choice:
            values[parameter.name] = random.below(static_cast<Index>(parameter.choices.size()));
            break;
        case declare::ParameterKind::integer:
            values[parameter.name] = random_integer(parameter, faces, random);
            break;
        case declare::ParameterKind::real:
            values[parameter.name] = random_real(parameter, random);
            break;
        default:
            if (parameter.name != "skeleton_file") // no file of that name
                values[parameter.name] = random_text(random);
        }
    }
    return values;
}

std::string described(const declare::FilterDeclaration& filter,
                      const declare::ParameterValues& values) {
    std::ostringstream text;
    text << filter.menu_name;
    for (const auto& [name, value] : values) {
        text << ' ' << name << '=';
        std::visit([&](const auto& v) { text << v; }, value);
    }
    return text.str();
}

std::optional<declare::HostResult> attempt(const declare::FilterDeclaration& filter,
                                           const declare::HostMesh& host,
                                           const declare::ParameterValues& values,
                                           bool may_refuse) {
    SCOPED_TRACE(described(filter, values));
    // Sanitizers take longer.
    const std::chrono::seconds longest(from_environment("DEVSEG_PROPERTY_SECONDS", longest_run));
    const auto start = Clock::now();
    const std::clock_t used = std::clock();
    Progress progress([&](double, const char*) {
        const auto waited = Clock::now() - start;
        return waited < longest ||
               (waited < busy * longest && std::clock() - used < longest.count() * CLOCKS_PER_SEC);
    });
    try {
        return declare::run_filter(filter, host, values, progress);
    } catch (const InvalidMesh& error) {
        EXPECT_TRUE(may_refuse) << "refused: " << error.what();
    } catch (const InvalidParameter& error) {
        EXPECT_TRUE(may_refuse) << "refused: " << error.what();
    } catch (const NumericalFailure& error) {
        // Exact developability may be out of reach; everything else must find an answer.
        EXPECT_NE(filter.menu_name.find("Deform"), std::string::npos) << error.what();
    } catch (const std::exception& error) {
        ADD_FAILURE() << error.what();
    }
    return std::nullopt;
}

void expect_disks(const mesh::RawMesh& raw, const declare::HostResult& result, double weld) {
    ASSERT_EQ(result.chart_id.size(), raw.faces.size());
    ASSERT_EQ(result.seam_edges.size(), raw.faces.size());
    expect_agreement(raw, result);
    const Gated gated = behind_gate(raw, result, weld);
    ASSERT_TRUE(is_valid(gated.gate.mesh));
    ASSERT_TRUE(is_valid(gated.gate.mesh, gated.charts));
    for (Index c = 0; c < gated.charts.count; ++c) {
        EXPECT_TRUE(is_sound(gated.gate.mesh, gated.charts, c));
    }
}

void expect_valid_layout(const mesh::RawMesh& raw, const declare::HostResult& result, bool packed) {
    ASSERT_EQ(result.wedge_uv.size(), raw.faces.size());
    Eigen::AlignedBox2d box;
    for (const auto& corners : result.wedge_uv)
        for (const Vec2& p : corners) {
            ASSERT_TRUE(p.allFinite());
            box.extend(p);
        }
    if (packed) {
        EXPECT_TRUE(Eigen::AlignedBox2d(Vec2::Zero(), Vec2::Ones()).contains(box));
    }
    const Gated gated = behind_gate(raw, result, 0.0);
    EXPECT_EQ(flipped_faces(gated.uv), 0);
    const double extent = std::max(
        {box.sizes().maxCoeff(), box.max().cwiseAbs().maxCoeff(), box.min().cwiseAbs().maxCoeff()});
    EXPECT_EQ(overlapping_pairs(gated.uv, extent), 0);
    declare::HostMesh laid = host_of(raw);
    laid.wedge_uv = result.wedge_uv;
    const declare::HostResult measured = run("Charts: Measure Flattening", laid);
    EXPECT_EQ(value(measured, "flipped_faces_number"), 0);
    EXPECT_EQ(value(measured, "overlapping_faces_number"), 0);
    EXPECT_EQ(value(measured, "charts_number"), gated.charts.count);
    EXPECT_EQ(sound_charts(measured), gated.charts.count);
}

void expect_complete(const mesh::RawMesh& raw, const declare::HostResult& result) {
    const std::size_t faces = refined(raw, result).faces.size();
    const auto complete = [&](const char* what, const auto& values) {
        EXPECT_TRUE(values.empty() || values.size() == faces) << what;
    };
    complete("chart_id", result.chart_id);
    complete("seam_edges", result.seam_edges);
    complete("face_quality", result.face_quality);
    complete("face_color", result.face_color);
    complete("wedge_uv", result.wedge_uv);
    for (const double q : result.face_quality)
        EXPECT_TRUE(std::isfinite(q));
    for (const auto& corners : result.wedge_uv)
        for (const Vec2& p : corners)
            EXPECT_TRUE(p.allFinite());
    // A face that a map has collapsed is stretched infinitely: that may be said.
    for (const auto& [name, value] : result.values) {
        if (const auto* number = std::get_if<double>(&value)) {
            EXPECT_FALSE(std::isnan(*number)) << name;
        }
        if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
            for (const double n : *numbers)
                EXPECT_FALSE(std::isnan(n)) << name;
        }
    }
    if (!result.layer)
        return;
    const auto count = static_cast<Index>(result.layer->geometry.points.size());
    for (const Vec3& p : result.layer->geometry.points)
        EXPECT_TRUE(p.allFinite());
    for (const Triangle& t : result.layer->geometry.faces)
        EXPECT_TRUE(*std::min_element(t.begin(), t.end()) >= 0 &&
                    *std::max_element(t.begin(), t.end()) < count);
}

} // namespace devseg::checks
