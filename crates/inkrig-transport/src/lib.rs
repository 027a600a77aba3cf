//! Optimal transport between two metric spaces.
//!
//! Given the self-distances of a *control* (N points) and of a *source* (M points), and optionally a cost between
//! them, find a plan `T` of N x M nonnegative entries that sends each control point to source points so that distances
//! are kept: the fused semi-unbalanced Gromov-Wasserstein problem (FSUGW) of "MAMM (SIGGRAPH 2025), Sec. 3.2.4", after
//! "Xu & Gould 2024 (ASOT)":
//!
//! ```text
//! minimise   alpha GW(T) + (1 - alpha) W(T) + <B, T> + lambda KL(T^T 1 || q) - epsilon H(T)    with  T 1 = p,  T >= 0
//! GW(T) = sum_ijkl (Dy_ik - Dx_jl)^2 T_ij T_kl        W(T) = sum_ij C_ij T_ij
//! KL(c || q) = sum_j c_j log(c_j / q_j) - c_j + q_j    H(T) = -sum_ij T_ij log T_ij
//! p_i = 1/N,  q_j = 1/M
//! ```
//!
//! [`MmSinkhorn`] is the solver to use; [`MirrorDescent`] is the reference it is checked against. Both work on a
//! [`Problem`] and keep every buffer in a [`Workspace`], so that repeated solves allocate nothing. The crate knows
//! matrices and nothing of motion.
//!
//! What a plan should or may not do is said on the problem: [`Problem::with_linear`] adds a linear cost `B`, for soft
//! wishes; a [`Mask`] settles rows and forbids columns, exactly.
//!
//! Three sizes of problem:
//!
//! | points | distances | plan | gradient |
//! |---|---|---|---|
//! | up to about 3 000 | matrices ([`Problem::new`]) | dense | O(N M (N + M)) |
//! | as long as N M numbers fit | [`LowRank`], by [`Nystrom`] ([`Problem::with_distances`]) | dense | O(N M r) |
//! | more | [`LowRank`] ([`SparseProblem`]) | on a [`Support`] from a coarser plan | O((entries + N r + M r) r) |
//!
//! # Example
//!
//! ```
//! use inkrig_transport::{Mat, MmSinkhorn, Params, Problem, Workspace};
//!
//! // Four points on a line, and the same four points seen from the other end.
//! let line = |x: [f32; 4]| Mat::from_vec(4, 4, (0..16).map(|k| (x[k / 4] - x[k % 4]).abs()).collect());
//! let (control, source) = (line([0.0, 0.2, 0.5, 1.0])?, line([1.0, 0.5, 0.2, 0.0])?);
//!
//! let params = Params { alpha: 1.0, lambda: 0.1, epsilon: 0.005 };
//! let problem = Problem::new(control.view(), source.view(), None, params)?;
//! let mut workspace = Workspace::new(1);
//! let trace = MmSinkhorn { iterations: 50, ..MmSinkhorn::default() }.solve(&problem, &mut workspace)?;
//!
//! assert_eq!(trace.iterations, 50);
//! let plan = workspace.plan();
//! assert_eq!((0..4).map(|i| plan.best_source(i)).collect::<Vec<_>>(), [3, 2, 1, 0]);
//! # Ok::<(), inkrig_transport::TransportError>(())
//! ```

mod check;
mod distances;
mod error;
mod factor_product;
mod gradient;
mod gradient_rows;
mod isa;
mod kernels;
mod low_rank;
mod mask;
mod mat;
mod mirror_descent;
mod mm_sinkhorn;
mod nystrom;
mod objective;
mod padded;
mod parallel;
mod plan;
mod problem;
mod product;
mod real;
mod search;
mod softmax;
mod sparse_gradient;
mod sparse_mm;
mod sparse_problem;
mod sparse_workspace;
mod support;
mod trace;
mod windows;
mod workspace;

pub use distances::Distances;
pub use error::TransportError;
pub use gradient_rows::GradientRows;
pub use isa::Isa;
pub use low_rank::LowRank;
pub use mask::Mask;
pub use mat::{Mat, MatRef};
pub use mirror_descent::{MirrorDescent, Step};
pub use mm_sinkhorn::MmSinkhorn;
pub use nystrom::Nystrom;
pub use objective::{Terms, terms};
pub use parallel::{for_each, for_rows, with_threads};
pub use plan::Plan;
pub use problem::{Params, Problem};
pub use product::{matmul, matmul_transposed};
pub use real::Real;
pub use search::Search;
pub use softmax::row_softmax;
pub use sparse_problem::SparseProblem;
pub use sparse_workspace::SparseWorkspace;
pub use support::Support;
pub use trace::{Record, Trace};
pub use windows::Windows;
pub use workspace::{Start, Workspace};
