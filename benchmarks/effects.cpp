// Nothing unused is paid: the four models of tests/cpp/effects/proof.hpp for each kind of motion and each effect, one
// integration each. benchmarks/effects.py makes the table.
//
// One line an integration: kind; effect; model; final state in hexadecimal; steps; orders; guard evaluations;
// microseconds, least of several. With the argument "count" each is integrated twice instead, the second time as the
// function counted_integration(), for callgrind to count the instructions of and to write down after. What a model does
// where it begins a mode is left out of that: equations written by hand have no scene to read. There memory is given
// out from one block that starts anew for every integration, so that the history of the heap counts for nothing.
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

/// A model whose own work where modes begin is not counted.
class Aside : public HybridModel {
public:
    explicit Aside(const HybridModel& model) : model_(model) {}
    int variables() const override { return model_.variables(); }
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
};

}  // namespace

extern "C" {
[[gnu::noinline]] void counted_integration(Driver& driver, const std::vector<double>& x, double until, Record& record) {
    record = driver.run(0.0, x, until);
}
[[gnu::noinline]] void integration_is_over() { asm volatile(""); }
}

namespace {

Record counted(const HybridModel& model, const std::vector<double>& x, double until) {
    const Aside aside(model);
    Record record;
    {
        TaylorEngine engine(tolerance);
        used = 0;
        Driver driver(aside, engine, 100'000'000, {}, {}, tolerance * until);
        counted_integration(driver, x, until, record);
    }
    // what is handed back is in memory of its own
    used = block_size;
    return Record(record);
}

double microseconds(const HybridModel& model, const std::vector<double>& x, double until) {
    double least = 1e300;
    for (int i = 0; i < 200; ++i) {
        const auto start = std::chrono::steady_clock::now();
        const Record record = integrated(model, x, until);
        least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() * 1e6);
    }
    return least;
}

std::string hexadecimal(const Record& record) {
    std::vector<double> x(static_cast<std::size_t>(record.variables));
    record.last_state(x);
    std::string text;
    for (const double value : x) {
        unsigned long long bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        char digits[17];
        std::snprintf(digits, sizeof digits, "%016llx", bits);
        text += digits;
    }
    return text;
}

}  // namespace

int main(int argc, char** argv) {
    const bool counts = argc > 1 && std::strcmp(argv[1], "count") == 0;
    for (const Kind& kind : kinds())
        for (const std::string& effect : kind.effects) {
            const auto without = model_of(scene_of(kind, effect, Variant::without));
            const auto zero = model_of(scene_of(kind, effect, Variant::zero));
            const auto on = model_of(scene_of(kind, effect, Variant::on));
            const auto by_hand = bare_of(kind, effect);
            const std::pair<const char*, const HybridModel*> models[] = {
                {"without", without.get()}, {"zero", zero.get()}, {"bare", by_hand.get()}, {"on", on.get()}};
            for (const auto& [name, model] : models) {
                const std::vector<double> x = (model == on.get() ? on : without)->start();
                Record record;
                for (int i = 0; i < (counts ? 2 : 1); ++i) {
                    record = counted(*model, x, kind.until);
                    integration_is_over();
                }
                if (record.thrown) std::rethrow_exception(record.thrown);
                std::printf("%s;%s;%s;%s;%lld;%lld;%lld;%.3f\n", kind.name.c_str(), effect.c_str(), name,
                            hexadecimal(record).c_str(), static_cast<long long>(record.work.steps),
                            static_cast<long long>(record.work.right_hand_sides),
                            static_cast<long long>(record.work.guard_evaluations),
                            counts ? 0.0 : microseconds(*model, x, kind.until));
            }
        }
    return 0;
}
