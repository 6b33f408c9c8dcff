// Any options of any filter on a small mesh with texture coordinates.
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "devseg/base/errors.h"
#include "filters/export_filter.h"
#include "fuzz/bytes.h"

namespace devseg::fuzz {

namespace {

// A bent strip, laid flat, with a seam across.
declare::HostMesh strip() {
    declare::HostMesh host;
    constexpr int columns = 6;
    for (int i = 0; i <= columns; ++i)
        for (int j = 0; j < 2; ++j)
            host.geometry.points.emplace_back(i, 3.0 * j, 0.3 * i * i);
    for (int i = 0; i < columns; ++i)
        for (const Triangle& t :
             {Triangle{2 * i, 2 * i + 2, 2 * i + 1}, Triangle{2 * i + 1, 2 * i + 2, 2 * i + 3}}) {
            host.geometry.faces.push_back(t);
            std::array<Vec2, 3> corners{Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3& p = host.geometry.points[t[k]];
                corners[k] = Vec2(0.1 * p.x() * (1.0 + 0.15 * p.x()), 0.1 * p.y());
                corners[k].y() += i >= columns / 2 ? 0.5 : 0.0;
            }
            host.wedge_uv.push_back(corners);
        }
    return host;
}

declare::ParameterValue read_value(const declare::Parameter& parameter, Bytes& bytes,
                                   const std::string& file) {
    switch (parameter.kind) {
    case declare::ParameterKind::boolean:
        return bytes.flag();
    case declare::ParameterKind::choice:
        return bytes.below(12) - 2;
    case declare::ParameterKind::integer:
        if (parameter.name == "max_iterations")
            return bytes.below(12) - 1;
        return bytes.flag() ? bytes.below(24) - 3 : static_cast<int>(bytes.byte()) << 23;
    case declare::ParameterKind::real:
        return bytes.number();
    case declare::ParameterKind::text:
        return bytes.text(12);
    case declare::ParameterKind::output_file:
        break;
    }
    constexpr const char* extensions[] = {".svg", ".pdf", ".dxf", ".SVG", "", ".txt", "/", ".svg/"};
    return file + extensions[bytes.below(8)];
}

std::size_t files_in(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

void run_with_options(Bytes& bytes) {
    static const declare::HostMesh host = strip();
    static const std::filesystem::path folder = [] {
        const char* chosen = std::getenv("TMPDIR");
        auto path = std::filesystem::path(chosen == nullptr ? "/tmp" : chosen) / "devseg_fuzz";
        std::filesystem::create_directories(path);
        return path;
    }();
    const auto& filters = exporting::plugin_filters();
    const declare::FilterDeclaration& filter =
        filters[bytes.below(static_cast<int>(filters.size()))];
    declare::ParameterValues values;
    for (const declare::Parameter& parameter : filter.parameters)
        if (parameter.kind == declare::ParameterKind::output_file || bytes.below(3) == 0)
            values[parameter.name] = read_value(parameter, bytes, (folder / "p").string());
    Progress progress;
    const std::size_t before = files_in(folder);
    try {
        const declare::HostResult result = declare::run_filter(filter, host, values, progress);
        for (const auto& corners : result.wedge_uv)
            for (const Vec2& p : corners)
                if (!p.allFinite())
                    fail("coordinates that are no numbers");
    } catch (const Error&) { // told to the user
        if (files_in(folder) != before)
            fail("a refusal left a file");
        return;
    }
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        std::filesystem::remove(entry.path());
}

} // namespace

} // namespace devseg::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    devseg::fuzz::Bytes bytes(data, size);
    devseg::fuzz::run_with_options(bytes);
    return 0;
}
