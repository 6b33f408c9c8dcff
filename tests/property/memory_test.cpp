// Memory that runs out at any allocation is told by std::bad_alloc: no crash, no other error.
#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "devseg/base/parallel.h"
#include "property/cases.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"
#include "unit/temporary_folder.h"

namespace {
std::atomic<long> until_failure{-1}; // allocations of all threads; negative: none fails
std::atomic<long> counted{0};
} // namespace

// Not inlined: compilers then see memory from one family of functions freed by the other.
[[gnu::noinline]] void* operator new(std::size_t size) {
    counted.fetch_add(1, std::memory_order_relaxed);
    if (until_failure.load(std::memory_order_relaxed) >= 0 && until_failure.fetch_sub(1) == 0)
        throw std::bad_alloc();
    if (void* memory = std::malloc(size > 0 ? size : 1))
        return memory;
    throw std::bad_alloc();
}
// Sanitizers have their own, whose memory the functions below must not free; sorts ask for it.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    try {
        return operator new(size);
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace devseg {
namespace {

using checks::filters_named;

// Whether the work has ended with too little memory; any other exception is the test's.
template <class Work>
bool fails_at(long allocation, Work work) {
    until_failure = allocation;
    bool failed = false;
    try {
        work();
    } catch (const std::bad_alloc&) {
        failed = true;
    }
    until_failure = -1;
    return failed;
}

TEST(Memory, RunsOutWhileThreadsAreStarted) {
    for (const int threads : {1, 3}) {
        set_thread_limit(threads);
        for (long k = 0; k < 12; ++k) {
            std::atomic<int> runs{0};
            Progress progress;
            const bool failed = fails_at(k, [&] {
                parallel_for(
                    20, [&](int) { ++runs; }, progress);
            });
            EXPECT_TRUE(failed || runs == 20) << k; // all of the work, or an error
        }
    }
    set_thread_limit(0);
}

TEST(Memory, RunsOutAnywhereInAFilter) {
    const TemporaryFolder folder;
    declare::HostMesh host = checks::host_of(shapes::sphere(2));
    checks::take_charts(host, checks::run("Segmentation: D-Charts", host, {{"charts_number", 4}}));
    host.wedge_uv = checks::run("Charts: Flatten", host).wedge_uv;
    checks::for_random_cases(20, [&](shapes::Random& random) {
        const declare::FilterDeclaration& filter = checks::any_of(filters_named(""), random);
        declare::ParameterValues values;
        for (const declare::Parameter& parameter : filter.parameters) {
            if (parameter.kind == declare::ParameterKind::output_file)
                values[parameter.name] = folder.file("pattern.pdf");
            if (parameter.name == "charts_number")
                values[parameter.name] = 5;
        }
        SCOPED_TRACE(checks::described(filter, values));
        const long before = counted;
        const auto expected = checks::attempt(filter, host, values, true);
        const long all = counted - before;
        if (!expected) // out of reach for this mesh
            return;
        std::filesystem::remove(folder.file("pattern.pdf"));
        for (int i = 0; i < 4; ++i) {
            const long k = static_cast<long>(random.uniform(0.0, 1.0) * static_cast<double>(all));
            Progress progress;
            const bool failed =
                fails_at(k, [&] { declare::run_filter(filter, host, values, progress); });
            EXPECT_TRUE(!failed || folder.count() == 0) << "a file was left, allocation " << k;
            std::filesystem::remove(folder.file("pattern.pdf"));
        }
    });
}

} // namespace
} // namespace devseg
