//! Fresnel terms F = F0 (1 − Fc) + F90 Fc.

pub(super) mod schlick;
