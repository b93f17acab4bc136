// Nothing unused is paid: the four ways to a motion of tests/cpp/effects/proof.hpp for each kind of motion and each
// effect, and laws that are built in beside the same as functors. benchmarks/effects.py makes the tables.
//
// One line a motion: table; motion or law; effect; which; final state in hexadecimal; steps; orders; guard evaluations;
// microseconds, least of several. With the argument "count" each is integrated twice instead, by the function
// counted_integration(), for callgrind to count the instructions of and to write down after. What a model does where it
// begins a mode is left out of that, and how it tells how many variables there are: equations written by hand have no
// scene to read. There memory is given out from one block that starts anew for every integration, so that the history
// of the heap counts for nothing.
#include "../tests/cpp/effects/proof.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

// --- memory ---

constexpr std::size_t block_size = std::size_t{1} << 23;
alignas(4096) unsigned char block[block_size];
std::size_t used = block_size;  // nothing is given out from it

void* allocated(std::size_t size) {
    // enough for every alignment there is
    const std::size_t rounded = (size + 63) / 64 * 64;
    if (used + rounded <= block_size) {
        used += rounded;
        return block + used - rounded;
    }
    void* memory = std::aligned_alloc(64, rounded);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}
void released(void* memory) {
    if (memory < block || memory >= block + block_size) std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) { return allocated(size); }
void* operator new(std::size_t size, std::align_val_t) { return allocated(size); }
void operator delete(void* memory) noexcept { released(memory); }
void operator delete(void* memory, std::size_t) noexcept { released(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { released(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { released(memory); }

namespace {

using namespace rbdyn;
using namespace rbdyn::proof;

/// A model whose own work where modes begin is not counted, nor that to tell how many variables there are.
class Aside : public HybridModel {
public:
    explicit Aside(const HybridModel& model) : model_(model), variables_(model.variables()) {}
    int variables() const override { return variables_; }
    Mode undecided() const override { return model_.undecided(); }
    [[gnu::noinline]] Mode begin(double t, std::span<double> x) const override {
        return outside([&] { return model_.begin(t, x); });
    }
    [[gnu::noinline]] Mode next(const Mode& mode, std::span<const int> fired, double t, std::span<double> x,
                                std::vector<Happening>& happenings) const override {
        return outside([&] { return model_.next(mode, fired, t, x, happenings); });
    }

private:
    /// With memory from elsewhere, too.
    template <class F>
    static Mode outside(F&& f) {
        const std::size_t before = std::exchange(used, block_size);
        const Mode mode = f();
        used = before;
        return Mode(mode);
    }

    const HybridModel& model_;
    int variables_;
};

}  // namespace

extern "C" {
[[gnu::noinline]] void counted_integration(Driver& driver, const std::vector<double>& x, double until, Record& record) {
    record = driver.run(0.0, x, until);
}
[[gnu::noinline]] void integration_is_over() { asm volatile(""); }
}

namespace {

/// One integration of each model, with memory that starts anew.
std::vector<Record> counted(const Motions& motions, double until) {
    std::vector<Record> records;
    for (std::size_t i = 0; i < motions.models.size(); ++i) {
        const Aside aside(*motions.models[i]);
        Record record;
        {
            TaylorEngine engine(tolerance);
            used = 0;
            Driver driver(aside, engine, 100'000'000, {}, {}, tolerance * until);
            counted_integration(driver, motions.starts[i], until, record);
        }
        // what is handed back is in memory of its own
        used = block_size;
        records.push_back(Record(record));
    }
    return records;
}

double microseconds(const Motions& motions, double until) {
    double least = 1e300;
    for (int i = 0; i < 200; ++i) {
        const auto start = std::chrono::steady_clock::now();
        const std::vector<Record> records = integrated(motions, until);
        least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() * 1e6);
    }
    return least;
}

std::string hexadecimal(const std::vector<Record>& records) {
    std::string text;
    for (const Record& record : records) {
        std::vector<double> x(static_cast<std::size_t>(record.variables));
        record.last_state(x);
        for (const double value : x) {
            unsigned long long bits = 0;
            std::memcpy(&bits, &value, sizeof bits);
            char digits[17];
            std::snprintf(digits, sizeof digits, "%016llx", bits);
            text += digits;
        }
    }
    return text;
}

void print(const std::string& name, const char* which, const Motions& motions, double until, bool counts) {
    // what a model keeps for its next integration is not from the block
    std::vector<Record> records = integrated(motions, until);
    for (int i = 0; i < (counts ? 2 : 1); ++i) {
        records = counted(motions, until);
        integration_is_over();
    }
    Work work;
    for (const Record& record : records) {
        if (record.thrown) std::rethrow_exception(record.thrown);
        work.steps += record.work.steps;
        work.right_hand_sides += record.work.right_hand_sides;
        work.guard_evaluations += record.work.guard_evaluations;
    }
    std::printf("%s;%s;%s;%lld;%lld;%lld;%.3f\n", name.c_str(), which, hexadecimal(records).c_str(),
                static_cast<long long>(work.steps), static_cast<long long>(work.right_hand_sides),
                static_cast<long long>(work.guard_evaluations), counts ? 0.0 : microseconds(motions, until));
}

}  // namespace

int main(int argc, char** argv) {
    const bool counts = argc > 1 && std::strcmp(argv[1], "count") == 0;
    for (const Row& row : rows()) {
        const std::string name = "effects;" + row.motion + ";" + row.effect;
        print(name, "without", motions_of(row.without), row.until, counts);
        print(name, "zero", motions_of(row.zero), row.until, counts);
        print(name, "by hand", row.by_hand, row.until, counts);
        print(name, "on", motions_of(row.on), row.until, counts);
    }
    for (const OwnLaw& law : own_laws()) {
        const std::string name = "laws;" + law.law + ";";
        print(name, "built in", law.built_in, law.until, counts);
        print(name, "functor", law.functor, law.until, counts);
        print(name, "by hand", law.by_hand, law.until, counts);
    }
    return 0;
}
