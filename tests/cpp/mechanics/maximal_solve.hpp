// Definitions of mechanics/maximal.hpp: rows, what acts, what follows, and the motion.
#pragma once

#include "mechanics/maximal.hpp"

namespace rbdyn::test {

inline Maximal::Motion Maximal::started(std::size_t i, const std::vector<Motion>& all) const {
    const Part& p = parts_[i];
    const Motion parent = of(p.parent, all);
    Motion m;
    Vec place = parent.place(p.at), velocity = parent.speed(p.at);  // of the joint's point of the child
    m.r = parent.r;
    m.omega = parent.omega;
    const auto slide = [&](const Vec& axis, Real way, Real rate) {
        const Vec e = parent.r * axis;
        place += e * way;
        velocity += parent.omega.cross(Vec(e * way)) + e * rate;
    };
    const auto turned = [&](const Vec& axis, Real angle, Real rate) {
        m.omega += m.r * axis * rate;
        m.r = m.r * turn(axis, angle);
    };
    switch (p.kind) {
        case Kind::bead:
            m.r = Mat::Identity();
            m.omega = Vec::Zero();
            m.origin = place;
            m.velocity = velocity + parent.r * p.second.cross(-p.first).normalized() * p.v[0];
            return m;
        case Kind::free:
            m.origin = parent.place(p.at);
            m.velocity = parent.speed(p.at) + parent.r * p.velocity;
            m.r = parent.r * p.attitude;
            m.omega += m.r * p.omega;
            return m;
        case Kind::spherical:
            m.r = parent.r * p.attitude;
            m.omega += m.r * p.omega;
            break;
        case Kind::revolute:
        case Kind::turned: turned(p.first, p.q[0], p.v[0]); break;
        case Kind::prismatic:
        case Kind::pushed: slide(p.first, p.q[0], p.v[0]); break;
        case Kind::universal:
            turned(p.first, p.q[0], p.v[0]);
            turned(p.second, p.q[1], p.v[1]);
            break;
        case Kind::cylindrical:
            slide(p.first, p.q[1], p.v[1]);
            turned(p.first, p.q[0], p.v[0]);
            break;
        case Kind::planar:
            slide(p.first, p.q[0], p.v[0]);
            slide(p.second, p.q[1], p.v[1]);
            turned(p.first.cross(p.second), p.q[2], p.v[2]);
            break;
        default: m.r = parent.r * p.attitude;
    }
    m.origin = place - m.r * p.point;
    m.velocity = velocity - m.omega.cross(Vec(m.r * p.point));
    return m;
}

inline void Maximal::add_circle(Rows& rows, const std::vector<Motion>& all, int a, const Vec& p, int b, const Vec& q,
                                const Vec& inward, const Vec& normal) const {
    // where the point is now: off its place at the start, along the circle
    const Motion one = of(a, all), other = of(b, all);
    const Vec now = other.r.transpose() * (one.place(p) - other.origin), center = q + inward;
    const Vec radius = center - now, rate = one.speed(p) - other.speed(now);
    add_point(rows, all, a, p, b, now, other.r * normal, true);
    const Vec n = radius.normalized();
    add_point(rows, all, a, p, b, now, other.r * n, true, rate.squaredNorm() / radius.norm());
}

inline void Maximal::add_joint(Rows& rows, const std::vector<Motion>& all, int i) const {
    const Part& p = parts_[static_cast<std::size_t>(i)];
    const Motion parent = of(p.parent, all), own = of(i, all);
    rows.joint = i;
    rows.constraint = -1;
    const auto hold = [&] {
        for (int k = 0; k < 3; ++k) add_point(rows, all, i, p.point, p.parent, p.at, Vec::Unit(k), false);
    };
    const auto guide = [&](const Vec& axis) {
        for (const Vec& u : across(axis)) add_point(rows, all, i, p.point, p.parent, p.at, parent.r * u, true);
    };
    const auto swivel = [&](const Vec& axis) {
        for (const Vec& u : across(axis)) add_right_angle(rows, all, i, u, p.parent, axis);
    };
    switch (p.kind) {
        case Kind::free: break;
        case Kind::bead: add_circle(rows, all, i, Vec::Zero(), p.parent, p.at, p.first, p.second); break;
        case Kind::spherical: hold(); break;
        case Kind::revolute:
            hold();
            swivel(p.first);
            break;
        case Kind::prismatic:
            guide(p.first);
            add_turn(rows, i, p.parent, Vec::Zero());
            break;
        case Kind::universal:
            hold();
            // of the body its second axis, of the parent its first
            add_right_angle(rows, all, i, p.second, p.parent, p.first);
            break;
        case Kind::cylindrical:
            guide(p.first);
            swivel(p.first);
            break;
        case Kind::planar: {
            const Vec n = p.first.cross(p.second);
            add_point(rows, all, i, p.point, p.parent, p.at, parent.r * n, true);
            swivel(n);
            break;
        }
        case Kind::fixed:
            hold();
            add_turn(rows, i, p.parent, Vec::Zero());
            break;
        case Kind::turned: {
            hold();
            const Vec e = parent.r * p.first;
            add_turn(rows, i, p.parent, parent.omega.cross(Vec(own.omega - parent.omega)) + e * p.drive);
            break;
        }
        default:
            guide(p.first);
            add_point(rows, all, i, p.point, p.parent, p.at, parent.r * p.first, true, p.drive);
            add_turn(rows, i, p.parent, Vec::Zero());
    }
}

inline void Maximal::add_held(Rows& rows, const std::vector<Motion>& all, const Held& h) const {
    const Motion one = of(h.a, all), other = of(h.b, all);
    if (std::holds_alternative<Rod>(h.constraint)) {
        // (d . d)' = 0: d . d'' + d' . d' = 0
        const Vec d = one.place(h.at_a) - other.place(h.at_b), rate = one.speed(h.at_a) - other.speed(h.at_b);
        add_point(rows, all, h.a, h.at_a, h.b, h.at_b, d, false, -rate.dot(rate));
    } else if (std::holds_alternative<PointOnCurve>(h.constraint)) {
        add_circle(rows, all, h.a, h.at_a, h.b, h.at_b, h.inward, h.normal);
    } else if (std::holds_alternative<PointOnPlane>(h.constraint)) {
        add_point(rows, all, h.a, h.at_a, h.b, h.at_b, other.r * h.normal, true);
    } else {
        for (int k = 0; k < 3; ++k) add_point(rows, all, h.a, h.at_a, h.b, h.at_b, Vec::Unit(k), false);
    }
    for (const auto& [e, w] : h.angles) add_right_angle(rows, all, h.a, e, h.b, w);
}

inline std::vector<Maximal::Wrench> Maximal::acting(const std::vector<Motion>& all) const {
    std::vector<Wrench> w(parts_.size());
    const auto push = [&](int body, const Vec& point, const Vec& force) {
        if (body < 0) return;
        auto& own = w[static_cast<std::size_t>(body)];
        own.force += force;
        own.torque += arm(body, point, all).cross(force);
    };
    for (std::size_t i = 0; i < w.size(); ++i) w[i].force += wide(scene.gravity()) * parts_[i].mass;
    for (const Applied& l : loads_) {
        const auto i = static_cast<std::size_t>(l.body);
        const Motion& m = all[i];
        const Vec value = l.in_body ? Vec(m.r * l.value) : l.value;
        if (l.kind == 0) push(l.body, l.point, value);
        if (l.kind == 1) w[i].torque += value;
        if (l.kind == 2) {
            const Vec v = m.speed(l.point);
            push(l.body, l.point, -v * (l.one + l.three * v.norm()));
        }
        if (l.kind == 3) {
            const Part& p = parts_[i];
            const Scene::Body& started = scene.bodies()[i];
            const bool planar = p.kind == Kind::planar, single = p.kind == Kind::revolute;
            const Vec e = of(p.parent, all).r * (planar ? Vec(p.first.cross(p.second)) : p.first);
            const Real angle = single ? started.parameter : started.coordinates[planar ? 2 : 0],
                       rate = single ? started.speed : started.rates[planar ? 2 : 0];
            const Vec torque = -e * (l.one * (angle - l.two) + l.three * rate);
            w[i].torque += torque;
            if (p.parent >= 0) w[static_cast<std::size_t>(p.parent)].torque -= torque;
        }
    }
    for (const Applied& l : loads_) {
        if (l.kind != 4) continue;
        const auto i = static_cast<std::size_t>(l.body);
        const Part& p = parts_[i];
        const Scene::Body& started = scene.bodies()[i];
        const Vec force =
            of(p.parent, all).r * p.first * -(l.one * (started.parameter - l.two) + l.three * started.speed);
        push(l.body, p.point, force);
        if (p.parent < 0) continue;
        // along the slide, at the same place
        const Motion& parent = all[static_cast<std::size_t>(p.parent)];
        push(p.parent, parent.r.transpose() * (all[i].place(p.point) - parent.origin), -force);
    }
    for (const Coupled& c : springs_) {
        const Motion a = of(c.a, all), b = of(c.b, all);
        const Vec d = a.place(c.at_a) - b.place(c.at_b), v = a.speed(c.at_a) - b.speed(c.at_b), e = d.normalized();
        const Vec force = -e * (c.stiffness * (d.norm() - c.rest) + c.damping * e.dot(v));
        push(c.a, c.at_a, force);
        push(c.b, c.at_b, -force);
    }
    return w;
}

inline Maximal::Result Maximal::solve(const std::vector<Motion>& all) const {
    const auto n = static_cast<Eigen::Index>(parts_.size());
    Rows rows;
    for (int i = 0; i < static_cast<int>(n); ++i) add_joint(rows, all, i);
    rows.joint = -1;
    for (std::size_t k = 0; k < held_.size(); ++k) {
        rows.constraint = static_cast<int>(k);
        add_held(rows, all, held_[k]);
    }
    const auto m = static_cast<Eigen::Index>(rows.all.size());
    using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
    Matrix k = Matrix::Zero(6 * n + m, 6 * n + m);
    Eigen::Matrix<Real, Eigen::Dynamic, 1> right = Eigen::Matrix<Real, Eigen::Dynamic, 1>::Zero(6 * n + m);
    const auto acts = acting(all);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const Mat inertia = all[at].r * parts_[at].inertia * all[at].r.transpose();
        k.block<3, 3>(6 * i, 6 * i) = Mat::Identity() * parts_[at].mass;
        k.block<3, 3>(6 * i + 3, 6 * i + 3) = inertia;
        right.segment<3>(6 * i) = acts[at].force;
        right.segment<3>(6 * i + 3) = acts[at].torque - all[at].omega.cross(Vec(inertia * all[at].omega));
    }
    for (Eigen::Index r = 0; r < m; ++r) {
        const auto& row = rows.all[static_cast<std::size_t>(r)];
        const auto put = [&](int body, const Vec& f, const Vec& t) {
            if (body < 0) return;
            k.block<1, 3>(6 * n + r, 6 * body) = f.transpose();
            k.block<1, 3>(6 * n + r, 6 * body + 3) = t.transpose();
            k.block<3, 1>(6 * body, 6 * n + r) = -f;
            k.block<3, 1>(6 * body + 3, 6 * n + r) = -t;
        };
        put(row.a, row.force_a, row.torque_a);
        put(row.b, row.force_b, row.torque_b);
        right[6 * n + r] = row.right;
    }
    Eigen::FullPivLU<Matrix> lu(k);
    // what is left of dependent rows is rounding of doubles: of the start
    lu.setThreshold(1e-10L);
    Result result;
    result.rows = static_cast<int>(m);
    result.rank = static_cast<int>(lu.rank()) - static_cast<int>(6 * n);
    result.is_unique = lu.rank() == 6 * n + m;
    for (Eigen::Index i = 0; i < lu.rank(); ++i)
        result.least_pivot = std::min(result.least_pivot, std::abs(lu.matrixLU()(i, i)) / lu.maxPivot());
    const auto x = lu.solve(right).eval();
    result.joints.resize(parts_.size());
    result.held.resize(held_.size());
    for (Eigen::Index i = 0; i < n; ++i) {
        result.acceleration.push_back(x.segment<3>(6 * i));
        result.turning.push_back(x.segment<3>(6 * i + 3));
    }
    for (Eigen::Index r = 0; r < m; ++r) {
        const auto& row = rows.all[static_cast<std::size_t>(r)];
        Wrench& w = row.joint >= 0 ? result.joints[static_cast<std::size_t>(row.joint)]
                                   : result.held[static_cast<std::size_t>(row.held)];
        w.force += row.force_a * x[6 * n + r];
        w.torque += row.torque_a * x[6 * n + r];
    }
    // from G to the points that are held
    for (std::size_t i = 0; i < parts_.size(); ++i)
        result.joints[i].torque -= arm(static_cast<int>(i), parts_[i].point, all).cross(result.joints[i].force);
    for (std::size_t i = 0; i < held_.size(); ++i)
        result.held[i].torque -= arm(held_[i].a, held_[i].at_a, all).cross(result.held[i].force);
    return result;
}

/// Of every place, velocity and attitude its rate, in the same layout.
inline std::vector<Maximal::Motion> Maximal::rates(const std::vector<Motion>& all) const {
    const Result now = solve(all);
    std::vector<Motion> result(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Vec c = all[i].r * parts_[i].center, w = all[i].omega;
        Mat turning;
        turning << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
        result[i].r = turning * all[i].r;
        result[i].origin = all[i].velocity;
        result[i].velocity = now.acceleration[i] - now.turning[i].cross(c) - w.cross(w.cross(c));
        result[i].omega = now.turning[i];
    }
    return result;
}

inline std::vector<Maximal::Motion> Maximal::moved(std::vector<Motion> all, Real time, Real step) const {
    constexpr int columns = 8;  // of order 16
    const auto plus = [](std::vector<Motion> a, const std::vector<Motion>& b, Real h) {
        for (std::size_t i = 0; i < a.size(); ++i) {
            a[i].r += h * b[i].r;
            a[i].origin += h * b[i].origin;
            a[i].velocity += h * b[i].velocity;
            a[i].omega += h * b[i].omega;
        }
        return a;
    };
    const int steps = static_cast<int>(std::lround(time / step));
    for (int s = 0; s < steps; ++s) {
        const Real whole = time / static_cast<Real>(steps);
        const auto first = rates(all);
        std::vector<std::vector<Motion>> row, last;
        for (int j = 0; j < columns; ++j) {
            const int n = 2 * (j + 1);
            const Real h = whole / static_cast<Real>(n);
            std::vector<Motion> before = all, now = plus(all, first, h);
            for (int k = 1; k < n; ++k) {
                std::vector<Motion> next = plus(before, rates(now), 2 * h);
                before = std::move(now);
                now = std::move(next);
            }
            row = {std::move(now)};
            for (int k = 0; k < j; ++k) {
                const Real ratio = static_cast<Real>(j + 1) / static_cast<Real>(j - k), by = 1 / (ratio * ratio - 1);
                const auto& mine = row.back();
                row.push_back(plus(plus(mine, mine, by), last[static_cast<std::size_t>(k)], -by));
            }
            last = row;
        }
        all = row.back();
    }
    return all;
}

}  // namespace rbdyn::test
