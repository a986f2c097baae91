"""The step of any body in matrices: its equations, its root, its runs."""

from nonholo.kernels.general._step import GeneralBody, Workspace, increments, workspace
