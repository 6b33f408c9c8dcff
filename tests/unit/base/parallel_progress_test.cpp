#include <atomic>
#include <chrono>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/base/parallel.h"
#include "devseg/base/progress.h"
#include "devseg/base/worker.h"

namespace devseg {
namespace {

using Clock = std::chrono::steady_clock;

class ParallelFor : public testing::Test {
protected:
    void TearDown() override { set_thread_limit(0); }
};

TEST_F(ParallelFor, RunsEveryIndexOnce) {
    for (const int threads : {0, 1, 2, 7})
        for (const int count : {0, 1, 2, 3, 100, 5000}) {
            set_thread_limit(threads);
            std::vector<std::atomic<int>> runs(static_cast<std::size_t>(count));
            Progress progress;
            parallel_for(
                count, [&](int i) { ++runs[static_cast<std::size_t>(i)]; }, progress);
            for (const std::atomic<int>& n : runs)
                ASSERT_EQ(n, 1);
        }
}

TEST_F(ParallelFor, StartsTheLowestIndexFirst) {
    set_thread_limit(1);
    std::vector<int> order;
    Progress progress;
    parallel_for(
        50, [&](int i) { order.push_back(i); }, progress);
    for (int i = 0; i < 50; ++i)
        EXPECT_EQ(order.at(static_cast<std::size_t>(i)), i);
}

TEST_F(ParallelFor, UsesNoMoreThreadsThanAllowed) {
    for (const int threads : {1, 2, 3}) {
        set_thread_limit(threads);
        std::atomic<int> running{0};
        std::atomic<int> most{0};
        Progress progress;
        parallel_for(
            40,
            [&](int) {
                const int now = ++running;
                for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
                }
                std::this_thread::sleep_for(std::chrono::microseconds(300));
                --running;
            },
            progress);
        EXPECT_LE(most, threads);
        EXPECT_GE(most, 1);
    }
}

TEST_F(ParallelFor, ThrowsWhatTheLowestFailingIndexThrew) {
    const auto wait_for = [](const std::atomic<bool>& flag) { // but not for long
        for (int i = 0; i < 50 && !flag; ++i)
            std::this_thread::sleep_for(std::chrono::microseconds(100));
        std::this_thread::sleep_for(std::chrono::microseconds(500));
    };
    for (const int threads : {1, 2, 4})
        for (const bool lower_first : {true, false})
            for (int run = 0; run < 10; ++run) {
                set_thread_limit(threads);
                std::atomic<bool> started[2] = {};
                std::atomic<bool> fails[2] = {};
                Progress progress;
                try {
                    parallel_for(
                        60,
                        [&](int i) {
                            if (i != 20 && i != 21)
                                return;
                            const int own = i - 20;
                            started[own] = true;
                            if (threads > 1)
                                wait_for(lower_first == (own == 0) ? started[1 - own]
                                                                   : fails[1 - own]);
                            fails[own] = true;
                            throw InvalidParameter(std::to_string(i));
                        },
                        progress);
                    FAIL() << "no exception";
                } catch (const InvalidParameter& error) {
                    ASSERT_STREQ(error.what(), "20");
                }
            }
}

// Index 0 must be reported, however the threads are scheduled.
TEST_F(ParallelFor, ReportsTheLowestIndexWhenAllFail) {
    set_thread_limit(8);
    for (int run = 0; run < 300; ++run) {
        Progress progress;
        try {
            parallel_for(
                8, [](int i) { throw InvalidParameter(std::to_string(i)); }, progress);
            FAIL() << "no exception";
        } catch (const InvalidParameter& error) {
            ASSERT_STREQ(error.what(), "0") << "run " << run;
        }
    }
}

TEST_F(ParallelFor, StopsAfterAFailure) {
    set_thread_limit(2);
    std::atomic<int> started{0};
    Progress progress;
    EXPECT_THROW(parallel_for(
                     100000,
                     [&](int i) {
                         ++started;
                         if (i == 10)
                             throw InvalidParameter("ten");
                         std::this_thread::sleep_for(std::chrono::microseconds(20));
                     },
                     progress),
                 InvalidParameter);
    EXPECT_LT(started, 50000);
}

TEST_F(ParallelFor, CancelsWithinATenthOfASecondWhenTasksPoll) {
    for (const int threads : {1, 2, 4}) {
        set_thread_limit(threads);
        std::atomic<bool> stop{false};
        Progress progress([&](double, const char*) { return !stop.load(); });
        std::thread user([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(60));
            stop = true;
        });
        Clock::time_point asked;
        std::thread clock([&] {
            while (!stop)
                std::this_thread::sleep_for(std::chrono::microseconds(100));
            asked = Clock::now();
        });
        EXPECT_THROW(parallel_for(
                         4,
                         [&](int) { // longer than anyone would wait
                             const auto end = Clock::now() + std::chrono::seconds(20);
                             while (!progress.cancelled() && Clock::now() < end)
                                 std::this_thread::sleep_for(std::chrono::milliseconds(1));
                         },
                         progress),
                     Cancelled);
        const auto ended = Clock::now();
        user.join();
        clock.join();
        EXPECT_LT(ended - asked, std::chrono::milliseconds(100)) << threads;
        EXPECT_TRUE(progress.cancelled());
    }
}

TEST_F(ParallelFor, ReportsProgressFromTheCallingThreadOnly) {
    set_thread_limit(2);
    std::set<std::thread::id> callers;
    std::vector<double> fractions;
    Progress progress([&](double fraction, const char*) {
        callers.insert(std::this_thread::get_id());
        fractions.push_back(fraction);
        return true;
    });
    auto working = progress.part("work", 1.0);
    parallel_for(
        50, [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(4)); }, working);
    EXPECT_EQ(callers, std::set<std::thread::id>{std::this_thread::get_id()});
    EXPECT_GE(fractions.size(), 3U);
    EXPECT_GT(fractions.back(), 0.5);
}

TEST_F(ParallelFor, PassesOnWhatTheHostsCallbackThrows) {
    Progress progress([](double, const char*) -> bool { throw std::runtime_error("the host"); });
    std::atomic<int> done{0};
    const auto task = [&](int) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50)); // until the host was asked
        ++done;
    };
    EXPECT_THROW(parallel_for(3, task, progress), std::runtime_error);
    EXPECT_LE(done, 3);
}

void wait_for_the_next_call() {
    std::this_thread::sleep_for(std::chrono::milliseconds(25));
}

TEST(Progress, FractionsNeverGoBackAndPhasesAddUp) {
    std::vector<std::pair<double, std::string>> calls;
    Progress progress([&](double fraction, const char* phase) {
        calls.emplace_back(fraction, phase);
        return true;
    });
    auto first = progress.part("first", 0.25);
    wait_for_the_next_call();
    first.update(0.5);
    wait_for_the_next_call();
    first.update(0.2); // a worse guess than before
    auto second = progress.part("second", 0.5);
    wait_for_the_next_call();
    second.update(1.0);
    auto third = progress.part("third", 5.0); // more than is left
    wait_for_the_next_call();
    third.update(7.0);
    const std::vector<std::pair<double, std::string>> expected = {
        {0.0, "first"},   {0.125, "first"}, {0.125, "first"}, {0.25, "second"},
        {0.75, "second"}, {0.75, "third"},  {1.0, "third"}};
    EXPECT_EQ(calls, expected);
}

TEST(Progress, PartsShareWhatTheWholeHas) {
    std::vector<std::pair<double, std::string>> calls;
    Progress progress([&](double fraction, const char* name) {
        calls.emplace_back(fraction, name);
        return true;
    });
    {
        auto cutting = progress.part("cutting", 0.5);
        {
            auto round = cutting.part(0.5); // says nothing new, so nothing sooner
            wait_for_the_next_call();
            round.update(0.5);
            auto joining = round.part("joining", 0.5);
        } // both are at their ends
        wait_for_the_next_call();
        EXPECT_DOUBLE_EQ(cutting.left(), 0.5);
        cutting.update(0.5); // of what is left
    }
    auto packing = progress.part("packing", 0.25);
    wait_for_the_next_call();
    progress.update(0.0);
    const std::vector<std::pair<double, std::string>> expected = {
        {0.0, "cutting"},   {0.125, "cutting"}, {0.125, "joining"},
        {0.375, "cutting"}, {0.5, "packing"},   {0.75, "packing"}};
    EXPECT_EQ(calls, expected);
    EXPECT_DOUBLE_EQ(progress.left(), 0.25);
}

TEST(Progress, CallsAreNotMoreFrequentThanAHostCanShow) {
    int calls = 0;
    Progress progress([&](double, const char*) { return ++calls > 0; });
    const auto end = Clock::now() + std::chrono::milliseconds(110);
    while (Clock::now() < end)
        progress.update(0.5);
    EXPECT_GE(calls, 2);
    EXPECT_LE(calls, 7);
}

TEST(Progress, OnceCancelledItStaysCancelled) {
    int calls = 0;
    Progress progress([&](double, const char*) {
        ++calls;
        return false;
    });
    EXPECT_FALSE(progress.cancelled());
    EXPECT_NO_THROW(progress.check());
    EXPECT_THROW(static_cast<void>(progress.part("work", 1.0)), Cancelled);
    EXPECT_TRUE(progress.cancelled());
    EXPECT_THROW(progress.check(), Cancelled);
    EXPECT_THROW(progress.update(0.5), Cancelled);
    EXPECT_THROW(static_cast<void>(progress.part("more", 1.0)), Cancelled);
    EXPECT_EQ(calls, 1); // the host is not asked again
}

TEST(Progress, WithoutAHostThereIsNothingToCancel) {
    Progress progress;
    progress.update(1.0);
    progress.check();
    EXPECT_FALSE(progress.cancelled());
}

TEST(RunApart, ReportsAndErrorsComeThrough) {
    std::vector<std::pair<double, std::string>> calls;
    Progress progress([&](double fraction, const char* phase) {
        calls.emplace_back(fraction, phase);
        return true;
    });
    bool done = false;
    run_on_worker(
        [&](Progress& own) {
            const auto first = own.part("first", 0.5);
            const auto second = own.part("second", 0.5);
            done = true;
        },
        progress);
    EXPECT_TRUE(done);
    const std::vector<std::pair<double, std::string>> expected = {{0.0, "first"}, {0.5, "second"}};
    ASSERT_GE(calls.size(), expected.size());
    EXPECT_EQ(calls[0], expected[0]);
    EXPECT_EQ(calls[1], expected[1]);
    const auto fail = [](Progress&) { throw InvalidMesh("expected a test, found none"); };
    EXPECT_THROW(run_on_worker(fail, progress), InvalidMesh);
}

// Work that never looks at its progress object is abandoned, and what it owns lives on.
TEST(RunApart, CancellingDoesNotWaitForTheWork) {
    struct Owned {
        std::atomic<bool> may_end{false};
        std::atomic<bool> was_told{false};
    };
    const auto owned = std::make_shared<Owned>();
    int calls = 0;
    Progress progress([&](double, const char*) { return ++calls < 3; });
    const auto start = Clock::now();
    const auto work = [owned](Progress& own) {
        const auto part = own.part("deaf", 1.0);
        while (!owned->may_end)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        try {
            std::this_thread::sleep_for(std::chrono::milliseconds(25));
            own.check();
        } catch (const Cancelled&) {
            owned->was_told = true;
        }
    };
    EXPECT_THROW(run_on_worker(work, progress), Cancelled);
    EXPECT_LT(Clock::now() - start, std::chrono::seconds(2)); // on a busy machine; else 60 ms
    EXPECT_FALSE(owned->may_end);
    owned->may_end = true;
    for (int i = 0; i < 5000 && !owned->was_told; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_TRUE(owned->was_told);
}

// They keep their memory: a user who cancels again and again must not run out of it.
TEST(RunApart, WaitsWhileMuchIsLeftBehind) {
    const auto may_end = std::make_shared<std::atomic<bool>>(false);
    const auto deaf = [may_end](Progress& own) {
        const auto part = own.part("deaf", 1.0);
        while (!*may_end)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
    };
    for (int i = 0; i < 2; ++i) {
        Progress progress([](double, const char*) { return false; });
        EXPECT_THROW(run_on_worker(deaf, progress), Cancelled);
    }
    const auto runs = std::make_shared<std::atomic<int>>(0);
    const auto work = [runs](Progress&) { ++*runs; };
    int calls = 0;
    Progress impatient([&](double, const char*) { return ++calls < 3; });
    EXPECT_THROW(run_on_worker(work, impatient), Cancelled);
    EXPECT_EQ(*runs, 0);
    *may_end = true;
    Progress patient;
    run_on_worker(work, patient);
    EXPECT_EQ(*runs, 1);
}

} // namespace
} // namespace devseg
