// Scenes whose motion is known in closed form: every body by itself (body_form.hpp).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rbdyn/basics/form.hpp"
#include "rbdyn/basics/instant.hpp"
#include "rbdyn/basics/vector.hpp"
#include "rbdyn/closed_form/closed_form.hpp"
#include "rbdyn/model/state_map.hpp"
#include "rbdyn/rotation/euler_turns.hpp"
#include "rbdyn/scene/scene.hpp"
#include "rbdyn/special/body_form.hpp"
#include "rbdyn/special/single_laws.hpp"

namespace rbdyn::inline RBDYN_FORM {

/// All bodies of a scene.
class ClosedMotion : public ClosedForm {
public:
    struct Part {
        int first, first_rate;
        std::unique_ptr<const BodyForm> form;
    };
    ClosedMotion(StateMap map, std::vector<Part> parts) : map_(std::move(map)), parts_(std::move(parts)) {}

    void state(Instant since, std::span<double> x) const override;
    double error(double since, double /*wanted*/) const override;
    std::optional<Recurrence> recurrence(int body) const override;
    std::string name() const override;

private:
    /// All variables.
    void whole(Instant since, std::span<double> x) const;

    StateMap map_;
    std::vector<Part> parts_;
};

namespace planning {

/// The constant force on a body beside gravity, if nothing else acts on it but torsion springs and it acts at the
/// centre of mass.
std::optional<Vector3> only_constant_force(const Scene& scene, int index);

/// The closed form of a scene, and why there is none otherwise.
[[gnu::cold]] std::pair<std::shared_ptr<const ClosedMotion>, std::string> closed_motion(const Scene& scene,
                                                                                        const SingleLaws& laws);

}  // namespace planning

}  // namespace rbdyn::inline RBDYN_FORM
