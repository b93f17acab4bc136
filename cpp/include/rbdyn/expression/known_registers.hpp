// Which registers hold what machine code has computed: newest coefficients, lanes of them, sums.
//
// Who wants a value asks for it by its key before it is loaded. Registers are given away in turns, the one that was
// given longest ago first.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/expression/assembler.hpp"
#include "rbdyn/expression/code_memory.hpp"

#ifdef RBDYN_WRITES_MACHINE_CODE
namespace rbdyn::inline RBDYN_FORM::machine_code {

class KnownRegisters {
public:
    using Key = std::ptrdiff_t;  // >= 0
    static constexpr Vector none = 255;

    /// `count` registers, from `first` on.
    KnownRegisters(Vector first, std::size_t count) : first_(first), count_(count) { forget(); }

    /// The register that holds a value; none: it is in memory alone.
    Vector known(Key key) const {
        for (std::size_t i = 0; i < count_; ++i)
            if (keys_[i] == key) return static_cast<Vector>(first_ + i);
        return none;
    }
    /// One for a new value; what was in it is in memory alone from here on.
    Vector room() {
        const std::size_t i = oldest_;
        oldest_ = (oldest_ + 1) % count_;
        keys_[i] = nothing;
        return static_cast<Vector>(first_ + i);
    }
    /// From here on a register of room() holds that.
    void know(Vector at, Key key) { keys_[static_cast<std::size_t>(at - first_)] = key; }
    /// Nothing is in registers, as after a call.
    void forget() { keys_.fill(nothing); }

private:
    static constexpr Key nothing = -1;
    static constexpr std::size_t most = 16;

    Vector first_;
    std::size_t count_, oldest_ = 0;
    std::array<Key, most> keys_;
};

}  // namespace rbdyn::inline RBDYN_FORM::machine_code
#endif
