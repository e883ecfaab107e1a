"""Diffuse models that Mitsuba lacks, as Python BSDFs: Fujii's and the qualitative form of Oren and Nayar's.

They run in the JIT variants only (llvm, cuda): a scalar variant would call Python once per ray.
"""


def register(mi):
    """Registers `etendue_fujii` and `etendue_oren_nayar` in the variant now selected. Does nothing for scalar ones."""
    if mi.variant().startswith("scalar"):
        return
    import drjit as dr

    class RoughDiffuse(mi.BSDF):
        """A two-sided diffuse model, sampled by cosine. Subclasses give `value`, sr^-1 per unit albedo."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.albedo = mi.Color3f(props["albedo"])
            self.configure(props)
            flags = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
            self.m_components = [flags]
            self.m_flags = flags

        @staticmethod
        def flip(si, w):
            """`w` as seen from the side of the surface that `si.wi` is on."""
            return mi.Vector3f(w.x, w.y, dr.mulsign(w.z, mi.Frame3f.cos_theta(si.wi)))

        def sample(self, ctx, si, sample1, sample2, active=True):
            side = mi.Frame3f.cos_theta(si.wi)
            wo = mi.warp.square_to_cosine_hemisphere(sample2)
            active &= (side != 0) & (wo.z > 0)
            bs = dr.zeros(mi.BSDFSample3f)
            bs.pdf = mi.warp.square_to_cosine_hemisphere_pdf(wo)
            bs.wo = mi.Vector3f(wo.x, wo.y, dr.mulsign(wo.z, side))
            bs.eta = 1.0
            bs.sampled_type = mi.UInt32(+mi.BSDFFlags.DiffuseReflection)
            bs.sampled_component = 0
            # f cos / pdf = pi f.
            weight = self.albedo * (dr.pi * self.value(self.flip(si, si.wi), wo))
            return bs, dr.select(active, weight, 0)

        def eval(self, ctx, si, wo, active=True):
            wi, wo = self.flip(si, si.wi), self.flip(si, wo)
            active &= (wi.z > 0) & (wo.z > 0)
            return dr.select(active, self.albedo * (self.value(wi, wo) * wo.z), 0)

        def pdf(self, ctx, si, wo, active=True):
            wi, wo = self.flip(si, si.wi), self.flip(si, wo)
            active &= (wi.z > 0) & (wo.z > 0)
            return dr.select(active, mi.warp.square_to_cosine_hemisphere_pdf(wo), 0)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def eval_diffuse_reflectance(self, si, active=True):
            return self.albedo

        def to_string(self):
            return f"{type(self).__name__}[albedo={self.albedo}]"

    class Fujii(RoughDiffuse):
        """Fujii's improved Oren-Nayar: A + B s / t with A = 1 / (pi + (pi/2 - 2/3) sigma'), B = sigma' A."""

        def configure(self, props):
            sigma = float(props["roughness"])
            self.a = 1.0 / (dr.pi + (dr.pi / 2.0 - 2.0 / 3.0) * sigma)
            self.b = sigma * self.a

        def value(self, wi, wo):
            s = dr.dot(wi, wo) - wi.z * wo.z
            t = dr.select(s > 0, dr.maximum(dr.maximum(wi.z, wo.z), 1e-20), 1.0)
            return self.a + self.b * s / t

    class OrenNayar(RoughDiffuse):
        """Oren and Nayar's qualitative model, sigma the standard deviation of the slope angle in radians."""

        def configure(self, props):
            sigma2 = float(props["sigma"]) ** 2
            self.a = 1.0 - 0.5 * sigma2 / (sigma2 + 0.33)
            self.b = 0.45 * sigma2 / (sigma2 + 0.09)

        def value(self, wi, wo):
            # cos(phi_i - phi_o) sin(alpha) tan(beta) = s / max(cos), where s = sin sin cos(dphi).
            s = dr.dot(wi, wo) - wi.z * wo.z
            t = dr.maximum(dr.maximum(wi.z, wo.z), 1e-20)
            return (self.a + self.b * dr.maximum(s, 0.0) / t) / dr.pi

    mi.register_bsdf("etendue_fujii", Fujii)
    mi.register_bsdf("etendue_oren_nayar", OrenNayar)
