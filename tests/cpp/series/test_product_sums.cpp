// Sums of products of series, four lanes at a time, against the sums written out.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "random.hpp"
#include "rbdyn/series/product_sums.hpp"

namespace rbdyn::test_product_sums {
namespace {

constexpr int orders = 25;

/// Two sums of three products each of random series, order after order.
struct Sums {
    std::vector<std::vector<double>> series;
    std::vector<series::LaneValues> values;
    std::vector<series::LaneSeries> lanes;
    std::vector<series::LaneSpread> spreads;
    std::vector<series::LaneProduct> products;
    std::vector<series::LaneSum> sums;

    explicit Sums(std::uint64_t seed) : values(12 * orders) {
        test::Random random(seed);
        for (int i = 0; i < 7; ++i) {
            std::vector<double>& one = series.emplace_back();
            for (int k = 0; k < orders; ++k) one.push_back(random.uniform(-1.0, 1.0));
        }
        for (int i = 0; i < 12; ++i) {
            series::LaneSeries s{{}, {1.0, 1.0, 1.0, 1.0}, &values[static_cast<std::size_t>(i * orders)]};
            for (int l = 0; l < 4; ++l) s.from[l] = series[static_cast<std::size_t>((i + 2 * l) % 7)].data();
            if (i % 2 == 0) s.weight = series::Quad{0.5, -1.5, 2.0, 0.0};
            lanes.push_back(s);
        }
        // one in all lanes
        for (int l = 0; l < 4; ++l) lanes[1].from[l] = series[5].data();
        spreads.push_back({series[5].data(), lanes[1].to});
        for (int i = 0; i < 12; i += 2)
            products.push_back(
                {&values[static_cast<std::size_t>(i * orders)], &values[static_cast<std::size_t>((i + 1) * orders)]});
        for (int i = 0; i < 6; i += 3)
            sums.push_back({products.data() + i, products.data() + i + 3, series::Quad{}, series::Quad{}});
    }
    RBDYN_INLINE_LANES void advance(int k) {
        series::lanes::advance(lanes.data(), lanes.data() + lanes.size(), spreads.data(),
                               spreads.data() + spreads.size(), sums.data(), sums.data() + sums.size(), k);
    }
    /// Coefficient k of a sum in a lane, and the size of its terms.
    std::pair<long double, long double> written_out(int sum, int lane, int k) const {
        long double value = 0.0L, size = 0.0L;
        for (int p = 3 * sum; p < 3 * sum + 3; ++p)
            for (int j = 0; j <= k; ++j) {
                const auto& x = lanes[static_cast<std::size_t>(2 * p)];
                const auto& y = lanes[static_cast<std::size_t>(2 * p + 1)];
                const long double term =
                    static_cast<long double>(x.weight[lane]) * x.from[lane][j] * y.from[lane][k - j];
                value += term;
                size += std::abs(term);
            }
        return {value, size};
    }
};

void advance(Sums& sums, int k) { sums.advance(k); }
#ifdef RBDYN_WIDE_LANES
__attribute__((target("avx2"))) void advance_wide(Sums& sums, int k) { sums.advance(k); }
#endif

TEST(ProductSums, are_those_written_out) {
    Sums all(3);
    for (int k = 0; k < orders; ++k) {
        advance(all, k);
        for (int s = 0; s < 2; ++s)
            for (int l = 0; l < 4; ++l) {
                const auto [value, size] = all.written_out(s, l, k);
                EXPECT_LE(std::abs(all.sums[static_cast<std::size_t>(s)].sum[l] - value), 1e-15L * size) << k;
            }
    }
}

#ifdef RBDYN_WIDE_LANES
TEST(ProductSums, have_the_same_bits_on_every_processor) {
    if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this one has no lanes of four";
    Sums here(5), everywhere(5);
    for (int k = 0; k < orders; ++k) {
        advance_wide(here, k);
        advance(everywhere, k);
        for (std::size_t s = 0; s < 2; ++s)
            for (int l = 0; l < 4; ++l) EXPECT_EQ(here.sums[s].sum[l], everywhere.sums[s].sum[l]) << k;
    }
}
#endif

}  // namespace
}  // namespace rbdyn::test_product_sums
