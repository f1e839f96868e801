// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/material.h"

#include <gmock/gmock.h>

namespace vrc {
namespace {

Material of(std::vector<Lobe> lobes) {
  Material material;
  material.lobes = std::move(lobes);
  return material;
}

GgxLobe ggx(float reflectance, float alpha) {
  GgxLobe lobe;
  lobe.reflectance = Rgb::Constant(reflectance);
  lobe.alpha = alpha;
  return lobe;
}

GgxLobe metal(float reflectance, float alpha, float eta, float k) {
  GgxLobe lobe = ggx(reflectance, alpha);
  lobe.has_fresnel = true;
  lobe.eta = Rgb::Constant(eta);
  lobe.k = Rgb::Constant(k);
  return lobe;
}

PhongLobe phong(float reflectance, float exponent) { return {Rgb::Constant(reflectance), exponent}; }
LambertLobe lambert(float reflectance) { return {Rgb::Constant(reflectance)}; }

float reflectance(const Lobe& lobe) {
  return std::visit([](const auto& model) { return model.reflectance[0]; }, lobe);
}

TEST(Material, ScaleMultipliesEveryLobe) {
  Material material = of({lambert(0.4f), phong(0.6f, 10.0f), ggx(1.0f, 0.2f)});
  scale(material, 0.5f);
  EXPECT_FLOAT_EQ(reflectance(material.lobes[0]), 0.2f);
  EXPECT_FLOAT_EQ(reflectance(material.lobes[1]), 0.3f);
  EXPECT_FLOAT_EQ(reflectance(material.lobes[2]), 0.5f);
}

TEST(Material, EqualLobesMerge) {
  Material material = of({phong(0.1f, 20.0f), lambert(0.2f), phong(0.3f, 20.0f), lambert(0.1f),
                          ggx(0.05f, 0.3f), ggx(0.05f, 0.3f)});
  normalize_lobes(material);
  ASSERT_EQ(material.lobes.size(), 3u);
  EXPECT_FLOAT_EQ(reflectance(material.lobes[0]), 0.3f);
  ASSERT_TRUE(std::holds_alternative<GgxLobe>(material.lobes[1]));  // 1 / (2 * 0.09) is about 5.6
  EXPECT_FLOAT_EQ(reflectance(material.lobes[1]), 0.1f);
  ASSERT_TRUE(std::holds_alternative<PhongLobe>(material.lobes[2]));
  EXPECT_FLOAT_EQ(reflectance(material.lobes[2]), 0.4f);
}

TEST(Material, GgxMergesOnlyWhenAlphaAndMetalAgree) {
  const std::vector<std::pair<GgxLobe, std::size_t>> cases = {
      {metal(0.5f, 0.1f, 0.2f, 3.9f), 1},
      {metal(0.5f, 0.2f, 0.2f, 3.9f), 2},
      {metal(0.5f, 0.1f, 0.3f, 3.9f), 2},
      {metal(0.5f, 0.1f, 0.2f, 2.0f), 2},
      {ggx(0.5f, 0.1f), 2},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    Material material = of({metal(0.5f, 0.1f, 0.2f, 3.9f), cases[i].first});
    normalize_lobes(material);
    EXPECT_EQ(material.lobes.size(), cases[i].second) << "case " << i;
  }
  GgxLobe unused_metal = ggx(0.5f, 0.1f);
  unused_metal.eta = Rgb::Constant(7.0f);
  Material material = of({ggx(0.5f, 0.1f), unused_metal});
  normalize_lobes(material);
  EXPECT_EQ(material.lobes.size(), 1u) << "without Fresnel, eta and k say nothing";
}

TEST(Material, BlackLobesAreDropped) {
  Material material = of({lambert(0.0f), phong(0.2f, 5.0f), ggx(0.0f, 0.1f)});
  normalize_lobes(material);
  ASSERT_EQ(material.lobes.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<PhongLobe>(material.lobes[0]));

  LambertLobe blue;
  blue.reflectance = Rgb(0.0f, 0.0f, 0.1f);
  material = of({blue});
  normalize_lobes(material);
  EXPECT_EQ(material.lobes.size(), 1u);
}

TEST(Material, LobesAreOrderedBySharpness) {
  Material material =
      of({ggx(0.1f, 0.05f), phong(0.1f, 100.0f), phong(0.1f, 2.0f), lambert(0.1f), ggx(0.1f, 0.1f)});
  normalize_lobes(material);
  ASSERT_EQ(material.lobes.size(), 5u);
  EXPECT_TRUE(std::holds_alternative<LambertLobe>(material.lobes[0]));
  EXPECT_EQ(std::get<PhongLobe>(material.lobes[1]).exponent, 2.0f);
  EXPECT_EQ(std::get<GgxLobe>(material.lobes[2]).alpha, 0.1f);  // like a Phong exponent of 50
  EXPECT_EQ(std::get<PhongLobe>(material.lobes[3]).exponent, 100.0f);
  EXPECT_EQ(std::get<GgxLobe>(material.lobes[4]).alpha, 0.05f);  // like 200
}

TEST(Material, BlendWeightIsTheShareOfTheSecond) {
  Material first = of({lambert(0.8f), phong(0.4f, 10.0f)});
  first.name = "first";
  const Material second = of({lambert(0.4f), ggx(1.0f, 0.05f)});
  const Material mixed = blend(first, second, 0.25f);
  EXPECT_EQ(mixed.name, "first");
  ASSERT_EQ(mixed.lobes.size(), 3u);
  EXPECT_FLOAT_EQ(reflectance(mixed.lobes[0]), 0.75f * 0.8f + 0.25f * 0.4f);
  EXPECT_FLOAT_EQ(reflectance(mixed.lobes[1]), 0.75f * 0.4f);
  EXPECT_FLOAT_EQ(reflectance(mixed.lobes[2]), 0.25f);

  EXPECT_EQ(blend(first, second, 0.0f).lobes.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<GgxLobe>(blend(first, second, 1.0f).lobes[1]));
}

TEST(Material, BlendIsTwoSidedWhenEitherPartIs) {
  Material front = of({lambert(0.5f)});
  Material both = front;
  both.two_sided = true;
  EXPECT_FALSE(blend(front, front, 0.5f).two_sided);
  EXPECT_TRUE(blend(front, both, 0.5f).two_sided);
  EXPECT_TRUE(blend(both, front, 0.5f).two_sided);
}

}  // namespace
}  // namespace vrc
