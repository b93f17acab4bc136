// Definitions of rbdyn/expression/value_code.hpp.
#pragma once

#include "rbdyn/expression/value_code.hpp"

#include <atomic>
#include <memory>
#include <optional>
#include <utility>

#include "rbdyn/expression/code_memory.hpp"
#include "rbdyn/expression/program.hpp"
#include "rbdyn/expression/value_code_writer.hpp"

namespace rbdyn::inline RBDYN_FORM {

RBDYN_INLINE std::unique_ptr<const ValueCode> ValueCode::of([[maybe_unused]] const Program& program) {
#ifdef RBDYN_WRITES_MACHINE_CODE
    if (!CodeMemory::is_usable() || !ValueCodeWriter::takes(program)) return nullptr;
    ValueCodeWriter writer(program);
    std::optional<CodeMemory> memory = CodeMemory::of(writer.write());
    if (memory) return std::unique_ptr<const ValueCode>(new ValueCode(std::move(*memory)));
#endif
    return nullptr;
}

RBDYN_INLINE KeptValueCode& KeptValueCode::operator=(const KeptValueCode& other) {
    if (this != &other) clear();
    return *this;
}

RBDYN_INLINE KeptValueCode::~KeptValueCode() { clear(); }

RBDYN_INLINE void KeptValueCode::clear() {
    delete code_.exchange(nullptr);
    evaluations_ = 0;
    is_refused_ = false;
}

RBDYN_INLINE const ValueCode* KeptValueCode::after(const Program& program, int evaluations) const {
    if (const ValueCode* const made = get()) return made;
    if (is_refused_.load(std::memory_order_relaxed) ||
        evaluations_.fetch_add(evaluations) + evaluations < ValueCode::evaluations)
        return nullptr;
    std::unique_ptr<const ValueCode> code = ValueCode::of(program);
    if (code == nullptr) {
        is_refused_ = true;
        return nullptr;
    }
    // another thread may have been quicker
    const ValueCode* made = nullptr;
    return code_.compare_exchange_strong(made, code.get()) ? code.release() : made;
}

}  // namespace rbdyn::inline RBDYN_FORM
