// Meshes from elsewhere through all filters, for builds that no host can load: with sanitizers.
// DEVSEG_MESHES is a folder of OFF files, which tests/python/dump_meshes.py makes of any files;
// with DEVSEG_CORPUS=full every one takes all methods of segmentation.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "property/cases.h"
#include "unit/host_checks.h"
#include "unit/temporary_folder.h"

namespace devseg {
namespace {

using checks::attempt;
using checks::filters_named;

// Numbers as the dump writes them, nan and inf among them, which streams do not read.
mesh::RawMesh read_off(const std::filesystem::path& path) {
    std::ifstream in(path);
    const auto word = [&] {
        std::string text;
        in >> text;
        return text;
    };
    mesh::RawMesh mesh;
    EXPECT_EQ(word(), "OFF") << path;
    mesh.points.resize(at(std::stoi(word())));
    mesh.faces.resize(at(std::stoi(word())));
    word(); // edges, which nobody counts
    for (Vec3& p : mesh.points)
        for (Index k = 0; k < 3; ++k)
            p[k] = std::stod(word());
    for (Triangle& t : mesh.faces) {
        EXPECT_EQ(word(), "3") << path;
        for (Index& v : t)
            v = std::stoi(word());
    }
    EXPECT_TRUE(in) << path;
    return mesh;
}

declare::ParameterValues usual_values(const declare::FilterDeclaration& filter, Index faces,
                                      const std::string& file) {
    declare::ParameterValues values;
    for (const declare::Parameter& parameter : filter.parameters) {
        if (parameter.name == "charts_number") // filters refuse more than there are faces
            values[parameter.name] = std::clamp(faces, 1, std::get<int>(parameter.default_value));
        if (parameter.kind == declare::ParameterKind::output_file)
            values[parameter.name] = file;
    }
    return values;
}

// One way through the suite: charts, their layout, and everything that reads both.
void run_all_filters(const mesh::RawMesh& raw, const declare::FilterDeclaration& segmentation,
                     const std::string& file) {
    declare::HostMesh host = checks::host_of(raw);
    const auto run = [&](const declare::FilterDeclaration& filter) {
        const auto start = std::chrono::steady_clock::now();
        const auto result = attempt(
            filter, host, usual_values(filter, static_cast<Index>(raw.faces.size()), file), true);
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (seconds > 20.0)
            std::cout << filter.menu_name << ": " << seconds << " s\n";
        if (result)
            checks::expect_complete(raw, *result);
        return result;
    };
    if (const auto charts = run(segmentation)) {
        checks::expect_disks(raw, *charts);
        checks::take_charts(host, *charts);
    }
    for (const declare::FilterDeclaration* filter : filters_named("")) {
        if (filter->menu_name.find("Segmentation:") == 0)
            continue;
        const auto result = run(*filter);
        if (!result || filter->menu_name != "Charts: Flatten")
            continue;
        checks::expect_valid_layout(raw, *result, true);
        checks::take_charts(host, *result);
        host.wedge_uv = result->wedge_uv;
    }
}

TEST(Corpus, AllFiltersAnswerOrRefuse) {
    const char* chosen = std::getenv("DEVSEG_MESHES");
    if (chosen == nullptr)
        GTEST_SKIP() << "no folder of meshes (DEVSEG_MESHES)";
    const char* amount = std::getenv("DEVSEG_CORPUS");
    const bool full = amount != nullptr && std::string(amount) == "full";
    const TemporaryFolder folder;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(chosen))
        if (entry.path().extension() == ".off")
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    ASSERT_FALSE(files.empty());
    const auto methods = filters_named("Segmentation:");
    for (std::size_t i = 0; i < files.size(); ++i) {
        SCOPED_TRACE(files[i].string());
        const mesh::RawMesh raw = read_off(files[i]);
        std::cout << files[i].filename().string() << std::endl; // the last one is the culprit
        // Every method on small meshes, which hold most of what can be wrong; one on others.
        for (std::size_t k = 0; k < methods.size(); ++k)
            if (full || raw.faces.size() < 1000 || k == i % methods.size())
                run_all_filters(raw, *methods[k], folder.file("pattern.pdf"));
    }
}

} // namespace
} // namespace devseg
