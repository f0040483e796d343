"""Where each law comes from."""

from types import MappingProxyType

SOURCES = MappingProxyType(
    {
        "paper": "Modelling of the pendulum-driven cart system with friction.",
        "coulomb1785": "C. A. Coulomb. Théorie des machines simples. 1785.",
        "morin1833": "A. J. Morin. New friction experiments carried out at Metz. 1833.",
        "reynolds1886": (
            "O. Reynolds. On the theory of lubrication and its application to Mr Beauchamp Tower's"
            " experiments. Phil. Trans. R. Soc. 177, 1886."
        ),
        "stribeck1902": (
            "R. Stribeck. Die wesentlichen Eigenschaften der Gleit- und Rollenlager."
            " Zeitschrift des VDI 46, 1902."
        ),
        "dieterich1979": (
            "J. H. Dieterich. Modeling of rock friction, part 1: experimental results and"
            " constitutive equations. Journal of Geophysical Research 84(B5), 1979."
        ),
        "ruina1983": (
            "A. Ruina. Slip instability and state variable friction laws. Journal of Geophysical"
            " Research 88(B12), 1983."
        ),
        "marone1998": (
            "C. Marone. Laboratory-derived friction laws and their application to seismic faulting."
            " Annual Review of Earth and Planetary Sciences 26, 1998."
        ),
        "perrin1995": (
            "G. Perrin, J. R. Rice, G. Zheng. Self-healing slip pulse on a frictional surface."
            " Journal of the Mechanics and Physics of Solids 43(9), 1995."
        ),
        "nagata2012": (
            "K. Nagata, M. Nakatani, S. Yoshida. A revised rate- and state-dependent friction law"
            " obtained by constraining constitutive and evolution laws separately with laboratory"
            " data. Journal of Geophysical Research 117(B2), 2012."
        ),
        "lapusta2000": (
            "N. Lapusta, J. R. Rice, Y. Ben-Zion, G. Zheng. Elastodynamic analysis for slow"
            " tectonic loading with spontaneous rupture episodes on faults with rate- and"
            " state-dependent friction. Journal of Geophysical Research 105(B10), 2000."
        ),
        "bo1982": (
            "L. C. Bo, D. Pavelescu. The friction-speed relation and its influence on the critical"
            " velocity of stick-slip motion. Wear 82, 1982."
        ),
        "armstrong1991": "B. Armstrong-Hélouvry. Control of Machines with Friction. Kluwer, 1991.",
        "dahl1968": (
            "P. R. Dahl. A solid friction model. Aerospace Corporation TOR-0158(3107-18)-1, 1968."
        ),
        "canudas1995": (
            "C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky. A new model for control of"
            " systems with friction. IEEE Transactions on Automatic Control 40(3), 1995."
        ),
        "canudas1999": (
            "C. Canudas de Wit, P. Tsiotras. Dynamic tire friction models for vehicle traction"
            " control. 38th IEEE Conference on Decision and Control, 1999."
        ),
        "newton1687": "I. Newton. Philosophiae naturalis principia mathematica, book II. 1687.",
        "bittencourt2012": (
            "A. C. Bittencourt, S. Gunnarsson. Static friction in a robot joint: modeling and"
            " identification of load and temperature effects. Journal of Dynamic Systems,"
            " Measurement, and Control 134(5), 2012."
        ),
        "janot2019": (
            "A. Janot, M. Gautier, M. Brunot. Data set and reference models of EMPS. Workshop on"
            " Nonlinear System Identification Benchmarks, 2019."
        ),
        "otter1999": (
            "M. Otter, H. Elmqvist, S. E. Mattsson. Hybrid modeling in Modelica based on the"
            " synchronous data flow principle. CACSD'99, Hawaii, 1999."
        ),
        "tustin1947": (
            "A. Tustin. The effects of backlash and of speed-dependent friction on the stability of"
            " closed-cycle control systems. Journal of the IEE 94(2A), 1947."
        ),
        "hess1990": (
            "D. P. Hess, A. Soom. Friction at a lubricated line contact operating at oscillating"
            " sliding velocities. Journal of Tribology 112(1), 1990."
        ),
        "popp1990": (
            "K. Popp, P. Stelter. Stick-slip vibrations and chaos. Phil. Trans. R. Soc. A 332,"
            " 1990."
        ),
        "andersson2007": (
            "S. Andersson, A. Söderberg, S. Björklund. Friction models for sliding dry, boundary"
            " and mixed lubricated contacts. Tribology International 40(4), 2007."
        ),
        "mostaghel1997": (
            "N. Mostaghel, T. Davis. Representations of Coulomb friction for dynamic analysis."
            " Earthquake Engineering and Structural Dynamics 26(5), 1997."
        ),
        "ambrosio2003": (
            "J. A. C. Ambrósio. Impact of rigid and flexible multibody systems: deformation"
            " description and contact models. Virtual Nonlinear Multibody Systems, Kluwer, 2003."
        ),
        "threlfall1978": (
            "D. C. Threlfall. The inclusion of Coulomb friction in mechanisms programs with"
            " particular reference to DRAM. Mechanism and Machine Theory 13(4), 1978."
        ),
        "brown2016": (
            "P. Brown, J. McPhee. A continuous velocity-based friction model for dynamics and"
            " control with physically meaningful parameters. Journal of Computational and Nonlinear"
            " Dynamics 11(5), 2016."
        ),
        "simscape": "The MathWorks. Simscape: Translational Friction. Documentation of the block.",
        "olsson1996": "H. Olsson. Control Systems with Friction. Thesis, Lund University, 1996.",
        "dupont2002": (
            "P. Dupont, V. Hayward, B. Armstrong, F. Altpeter. Single state elastoplastic friction"
            " models. IEEE Transactions on Automatic Control 47(5), 2002."
        ),
        "bouc1967": (
            "R. Bouc. Forced vibration of mechanical systems with hysteresis. 4th Conference on"
            " Nonlinear Oscillation, Prague, 1967."
        ),
        "wen1976": (
            "Y.-K. Wen. Method for random vibration of hysteretic systems. Journal of the"
            " Engineering Mechanics Division 102(2), 1976."
        ),
        "iwan1966": (
            "W. D. Iwan. A distributed-element model for hysteresis and its steady-state dynamic"
            " response. Journal of Applied Mechanics 33(4), 1966."
        ),
        "simoni2015": (
            "L. Simoni, M. Beschi, G. Legnani, A. Visioli. Friction modeling with temperature"
            " effects for industrial robot manipulators. IEEE/RSJ IROS, 2015."
        ),
        "duclusaud2025": (
            "M. Duclusaud, G. Passault, V. Padois, O. Ly. Extended friction models for the physics"
            " simulation of servo actuators. IEEE ICRA, 2025."
        ),
        "albender2005": (
            "F. Al-Bender, V. Lampaert, J. Swevers. The generalized Maxwell-slip model: a novel"
            " model for friction simulation and compensation. IEEE Transactions on Automatic"
            " Control 50(11), 2005."
        ),
        "lampaert2003": (
            "V. Lampaert, F. Al-Bender, J. Swevers. A generalized Maxwell-slip friction model"
            " appropriate for control purposes. IEEE International Conference on Physics and"
            " Control, 2003."
        ),
        "olsson1998": (
            "H. Olsson, K. J. Åström, C. Canudas de Wit, M. Gäfvert, P. Lischinsky. Friction models"
            " and friction compensation. European Journal of Control 4(3), 1998."
        ),
        "haessig1991": (
            "D. A. Haessig, B. Friedland. On the modeling and simulation of friction. Journal of"
            " Dynamic Systems, Measurement, and Control 113(3), 1991."
        ),
        "bliman1995": (
            "P.-A. Bliman, M. Sorine. Easy-to-use realistic dry friction models for automatic"
            " control. 3rd European Control Conference, Rome, 1995."
        ),
    }
)
"""Citation in plain text by key."""
