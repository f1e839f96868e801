// SPDX-License-Identifier: GPL-3.0-or-later
#include "mitsuba_bsdf.h"

#include <cmath>

#include "conductors.h"
#include "core/error.h"

namespace vrc {
namespace {

// A reference may lead back to its own BSDF; no sensible material nests this deep.
constexpr int kMaxNesting = 8;

Material read_nested(const XmlElement& element, MitsubaContext& context, int depth);

Material read_diffuse(const XmlElement& element, MitsubaContext& context) {
  Properties properties(element, context);
  LambertLobe lobe;
  const std::optional<Rgb> old_name = properties.color("diffuse_reflectance");  // Mitsuba 0.6 took both names
  lobe.reflectance = properties.color("reflectance").value_or(old_name.value_or(lobe.reflectance));
  properties.finish();
  return {.name = {}, .lobes = {lobe}};
}

Material read_phong(const XmlElement& element, MitsubaContext& context) {
  Properties properties(element, context);
  LambertLobe diffuse;
  PhongLobe glossy;
  diffuse.reflectance = properties.color("diffuse_reflectance").value_or(diffuse.reflectance);
  glossy.reflectance = properties.color("specular_reflectance").value_or(glossy.reflectance);
  glossy.exponent = static_cast<float>(properties.number("exponent").value_or(glossy.exponent));
  if (!(glossy.exponent >= 0.0f) || !std::isfinite(glossy.exponent)) {
    fail(element, fmt::format("the exponent {} should be 0 or more", glossy.exponent));
  }
  properties.finish();
  return {.name = {}, .lobes = {diffuse, glossy}};
}

float read_alpha(const XmlElement& element, Properties& properties, MitsubaContext& context) {
  const double alpha = properties.number("alpha").value_or(0.1);
  const double alpha_u = properties.number("alpha_u").value_or(alpha);
  const double alpha_v = properties.number("alpha_v").value_or(alpha_u);
  if (!(alpha_u >= 1e-4 && alpha_v >= 1e-4)) {
    fail(element,
         fmt::format("the roughness alpha {:g} should be 0.0001 or more", std::min(alpha_u, alpha_v)));
  }
  if (alpha_u == alpha_v) return static_cast<float>(alpha_u);
  context.report.reject(element, "alpha_u and alpha_v differ; anisotropy is not supported, make them equal",
                        "their geometric mean is used");
  return static_cast<float>(std::sqrt(alpha_u * alpha_v));
}

void read_metal(const XmlElement& element, Properties& properties, GgxLobe& lobe) {
  const std::optional<std::string> name = properties.string("material");
  const std::optional<Rgb> eta = properties.color("eta");
  const std::optional<Rgb> k = properties.color("k");
  const auto outside = static_cast<float>(properties.number("ext_eta").value_or(1.0));
  if (!(outside > 0.0f)) fail(element, "ext_eta should be above 0");
  if (eta.has_value() != k.has_value()) fail(element, "eta and k belong together; give both or neither");
  if (eta && name) fail(element, "material and eta, k exclude each other; remove one");
  if (name == "none") return;
  lobe.has_fresnel = true;
  if (eta) {
    lobe.eta = *eta / outside;
    lobe.k = *k / outside;
    return;
  }
  const std::string metal_name = name.value_or("Cu");  // Mitsuba's default
  const std::optional<Conductor> metal = find_conductor(metal_name);
  if (!metal) {
    fail(element, fmt::format("the material '{}' is not known; use {}, none, or give eta and k", metal_name,
                              conductor_names()));
  }
  lobe.eta = Rgb(metal->eta[0], metal->eta[1], metal->eta[2]) / outside;
  lobe.k = Rgb(metal->k[0], metal->k[1], metal->k[2]) / outside;
}

Material read_roughconductor(const XmlElement& element, MitsubaContext& context) {
  Properties properties(element, context);
  const std::string distribution = properties.string("distribution").value_or("beckmann");
  if (distribution != "ggx") {
    context.report.reject(
        element,
        fmt::format("the distribution {} is not supported (Mitsuba's default is beckmann); add "
                    "<string name=\"distribution\" value=\"ggx\"/>",
                    distribution),
        "ggx is used");
  }
  GgxLobe lobe;
  lobe.alpha = read_alpha(element, properties, context);
  read_metal(element, properties, lobe);
  lobe.reflectance = properties.color("specular_reflectance").value_or(lobe.reflectance);
  properties.ignore({"sample_visible"});
  properties.finish();
  return {.name = {}, .lobes = {lobe}};
}

Material read_blend(const XmlElement& element, MitsubaContext& context, int depth) {
  Properties properties(element, context);
  if (!properties.has("weight"))
    fail(element, "the weight is missing; add <float name=\"weight\" value=\"...\"/>");
  const double weight = properties.number("weight").value_or(0.5);
  const std::vector<const XmlElement*> parts = properties.objects("bsdf");
  properties.finish();
  if (!(weight >= 0.0 && weight <= 1.0))
    fail(element, fmt::format("the weight {:g} is not in [0, 1]", weight));
  if (parts.size() != 2) fail(element, fmt::format("{} nested BSDFs; a blend has two", parts.size()));
  const Material first = read_nested(*parts[0], context, depth + 1);
  const Material second = read_nested(*parts[1], context, depth + 1);
  if (first.two_sided != second.two_sided) {
    context.report.reject(element,
                          "one part is two-sided and the other is not; put <bsdf type=\"twosided\"> "
                          "around the blend",
                          "both are taken as two-sided");
  }
  return blend(first, second, static_cast<float>(weight));
}

Material read_twosided(const XmlElement& element, MitsubaContext& context, int depth) {
  Properties properties(element, context);
  const std::vector<const XmlElement*> parts = properties.objects("bsdf");
  properties.finish();
  if (parts.empty()) fail(element, "no nested BSDF; put one inside");
  if (parts.size() > 1) {
    context.report.reject(*parts[1], "different BSDFs on the two sides are not supported; use one");
  }
  Material material = read_nested(*parts[0], context, depth + 1);
  material.two_sided = true;
  return material;
}

Material read_nested(const XmlElement& element, MitsubaContext& context, int depth) {
  if (depth > kMaxNesting) {
    fail(element,
         fmt::format("BSDFs nested more than {} deep; a <ref> may lead back to itself", kMaxNesting));
  }
  const std::string_view type = element.get("type");
  if (type == "diffuse") return read_diffuse(element, context);
  if (type == "phong") return read_phong(element, context);
  if (type == "roughconductor") return read_roughconductor(element, context);
  if (type == "blendbsdf") return read_blend(element, context, depth);
  if (type == "twosided") return read_twosided(element, context, depth);
  context.report.reject(element,
                        "this BSDF is not supported; use diffuse, phong, roughconductor, blendbsdf or "
                        "twosided",
                        "diffuse 0.5 is used");
  return default_material();
}

void check_energy(const XmlElement& element, const Material& material, MitsubaContext& context) {
  Rgb sum = Rgb::Zero();
  for (const Lobe& lobe : material.lobes) {
    sum += std::visit([](const auto& model) { return model.reflectance; }, lobe);
  }
  if (sum.maxCoeff() > 1.0001f) {
    context.report.warn(element,
                        fmt::format("reflectances add up to {:.4g}; above 1 the surface reflects more "
                                    "light than it receives",
                                    sum.maxCoeff()));
  }
}

}  // namespace

Material default_material() { return {.name = "default", .lobes = {LambertLobe{}}}; }

Material read_bsdf(const XmlElement& element, MitsubaContext& context) {
  Material material = read_nested(element, context, 0);
  material.name = element.get("id");
  normalize_lobes(material);
  check_energy(element, material, context);
  return material;
}

}  // namespace vrc
