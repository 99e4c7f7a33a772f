"""Pictures of water and cloth, drawn in NumPy: no display, no graphics driver.

Why neither PyVista (0.49.1, VTK 9.7.2) draws nor pysplashsurf (0.14.1) finds the surface: both were
tried on frames of the examples pour, curtain and two_resolutions at 1280 x 960, beside this code.

VTK draws through OpenGL. Its wheel brings no driver, the wheel with OSMesa is not on PyPI: where
the system has no libGL, libEGL or libOSMesa, as in a bare container, the first picture ends in a
segmentation fault. With Mesa there are either shadows or transparent water: the shadow pass leaves
transparent surfaces out. Water has no refraction and no color by the length of the ray, so that
drops look like flat discs. A frame of pour takes 3.1 s of processor time with shadows, 5.8 s with
transparent water, 9.3 s with ambient occlusion too; here, with shadows and water, 3 s.

pysplashsurf takes 0.4 s of processor time for the surface of a frame of pour instead of 0.6 s, and
1.7 s instead of at most 2.8 s for 207,000 particles. But one call has one particle radius: water of
two resolutions becomes two bodies, with bubbles where they meet. No smoothing length serves both
sheets and drops: with its default of one spacing and level 0.6 falling water is torn into balls;
wide enough to hold it together (1.3 to 1.5 spacings, level 0.3 to 0.5), a drop has 5 to 11 times
the volume of its particle, here 0.74. With several threads two runs may differ in the last bits.
"""
