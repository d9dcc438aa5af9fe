"""A small deck with every card that is read, in free field."""

CONTROL = """SOL 101
CEND
SPC = 50
MPC = 30
SUBCASE 1
 LOAD = 10
 BCSET = 8
 BOLTLD = 9
SUBCASE 2
 BCONTACT = 9
SUBCASE 3
 BCONTACT = 10
SUBCASE 4
 BGSET = 12
BEGIN BULK
"""


def grid(number: int, x: float, y: float, z: float) -> str:
    return f"GRID,{number},0,{x:.3f},{y:.3f},{z:.3f},0\n"


def cube(first: int, level: float) -> str:
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    places = [(x, y, z + level) for z in (0, 1) for x, y in square]
    return "".join(grid(first + i, *place) for i, place in enumerate(places))


SOLIDS = (
    cube(1, 0.0)
    + cube(11, 1.0)
    + grid(21, 2, 0, 0)
    + grid(22, 2, 1, 0)
    + grid(23, 2, 0, 1)
    + "CHEXA,1,1,1,2,3,4,5,6\n,7,8\nCHEXA,2,2,11,12,13,14,15,16\n,17,18\n"
    + "CPENTA,3,4,2,21,3,6,23,7\nCTETRA,4,3,21,22,3,23\n"
    + grid(24, 0.5, 0.5, -1)
    + "CPYRAM,5,3,1,4,3,2,24\n"
    + "PSOLID,1,9,,TWO,,FULL\nPSOLID,2,9,,TWO,,FULL\nMAT1,9,210000.,80769.23,.3,7.8-9\n"
    + "PSOLID,3,10,4\nMAT9,10,9.,1.,2.,.1,.2,.3,8.\n,1.,.1,.2,.3,7.,.1,.2,.3\n"
    + ",3.,.1,.2,4.,.1,5.,1.-9\n"
    + grid(25, 0.5, 0.5, 3)
    + "CPYRAM,6,5,15,16,17,18,25\nPCOMPS,5,,13\n,1,9,.2,0.\n,2,9,.4,90.\n"
    + "PSOLID,4,11\nMAT11,11,9.,8.,7.,.1,.2,.3,3.\n,4.,5.,1.-9\n"
)
LINES = (
    grid(91, 3, 0, 0)
    + grid(92, 3, 0, 1)
    + grid(93, 3, 0, 2)
    + grid(94, 4, 0, 0)
    + "".join(grid(n, x, y, 2) for n, x, y in ((97, 4, 1), (98, 5, 0), (99, 5, 1), (105, 3, 5)))
    + "".join(grid(n, x, 4, 1) for n, x in ((106, 2), (107, 6), (108, 8)))
    + "CBAR,71,50,91,92,1.,0.,0.\nCBEAM,72,51,92,93,1.,0.,0.\n"
    + "PBAR,50,9,1.,2.,3.,4.,.1\n,,,,,,,,\n,.8,.8,.5\n"
    + "PBEAM,51,9,1.,2.,3.,0.,4.\n,,,,,,,,\n,,,,,,,.5,.5\n"
    + "CBAR,73,52,91,94,93\nPBARL,52,9,,BOX\n,4.,4.,1.,1.\n"
    + "CBEAM,74,53,92,94,93\nPBEAML,53,9,,TUBE\n,2.,1.\n"
    + "CBAR,76,50,92,94,1.,0.,0.,GOO\n,,,.1,.2,.3,.1,.2,.3\n"
    + "BAROR,,50,,,1.,0.,0.\nCBAR,75,,91,92\n"
    + "CELAS1,61,60,94,1,93,1\nPELAS,60,50.,,,65,60.\nCELAS2,62,7.,94,2\n"
    + "CONM2,63,94,0,5.,0.,0.,0.\n,1.,.1,2.,.2,.3,3.\n"
)
STRUCTURE = (
    "SPOINT,101,102\nCELAS3,401,60,101,102\nCELAS4,402,4.,101\nCMASS1,403,41,94,1,93,1\n"
    "CMASS2,404,2.,94,2\nCMASS3,405,41,101\nCMASS4,406,3.,102\nPMASS,41,2.\n"
    "CROD,411,55,91,93\nPROD,55,9,1.,2.,,.1\nCTUBE,412,56,91,94\nPTUBE,56,9,2.,.5\n"
    "CONROD,413,92,94,9,1.,2.,,.1\n"
    "CBUSH,421,57,93,94,0.,1.,0.\n,.25\nCBUSH,422,57,94,,,,,4\n,,4,1.,2.,3.\n"
    "PBUSH,57,K,1.,2.,3.,4.,5.,6.\n,,M,.5\nCBUSH1D,423,58,92,94\nPBUSH1D,58,3.,,.1\n"
    "CBEND,424,64,93,105,97,,,3\nPBEND,64,9,1.,2.,3.,4.,5.\n,,,,,,,,\n,.5,.5,.1,,,.1\n"
    "PSHELL,59,9,.5,9,1.2,9,.8,.1\nPCOMP,61,-.2,.1\n,9,.2,30.,,8,.1,45.\n"
    "PCOMPG,62\n,1,8,.2,30.\n,2,7,.3,0.\n"
    "MAT8,8,100.,10.,.3,5.,4.,2.,1.\nMAT2,7,9.,1.,.1,8.,.2,3.,1.\n"
    "CQUAD4,431,59,94,98,99,97,30.,.1\n,,,.4,.5,.6,.5\nCTRIA3,432,61,92,93,97,4\n"
    "CTRIA6,435,59,92,93,97,,98,99\n,10.,.1,.4,.5,.6\nCSHEAR,437,63,94,98,99,97\n"
    "CQUAD8,436,61,94,98,99,97,,105\n,106,107,,,,,20.,.1\nPSHEAR,63,9,.5,.1,.5,1.5\n"
    "CQUADR,433,62,94,98,99,97\nCTRIAR,434,59,92,93,97,20.\n"
)
BARS = (
    "RBAR,441,93,105,1235,46\nRBE1,442,97,123456\n,UM,106,123\n"
    "RROD,443,98,107,,1\nRTRPLT,444,97,98,108,123,23,3\n,,,12\n"
)
TIES = (
    "CORD2R,4,0,0.,0.,0.,1.,0.,0.\n,0.,1.,0.\nCORD2C,5,0,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
    "CORD2S,6,5,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD1R,7,1,2,4,8,11,12,14\n"
    "GRID,95,5,2.,30.,0.,5\nGRID,96,6,2.,30.,10.,6,123\n"
    "CELAS2,65,7.,95,1\nRBE2,81,91,123456,1,2,THRU,4\nRBE3,82,,93,123456,1.,123,15,16\n,17,18,.5,123,11\n"
    "MPC,3,95,1,1.,94,1,-1.\n,,94,2,.5\nMPCADD,30,3\nSPC,5,94,3,0.,92,2,0.\n"
    "SPC1,5,12,11,THRU,13\nSPCADD,50,5\n"
)
LOADS = (
    "FORCE,1,94,0,2.,1.,2.,3.\nMOMENT,1,93,4,2.,1.,2.,3.\nLOAD,10,2.,1.5,1,.5,2\n"
    "SLOAD,1,101,2.,102,3.\nFORCE1,1,94,2.,91,92\nMOMENT1,1,93,2.,91,94\nFORCE2,1,94,2.,91,92,93,94\n"
    "MOMENT2,1,93,2.,91,94,92,93\nPLOAD,2,1.5,1,2,3,4\nPLOAD,2,.5,1,2,3\n"
    "PLOAD2,2,2.,431,THRU,432\nPLOAD2,2,2.,433,434\n"
    "PLOAD1,1,71,FY,FR,.1,2.,.8,3.\nPLOAD1,1,72,MZE,LE,.3,2.\nPLOAD1,1,74,FX,LEPR,.1,1.,.3,2.\n"
    "PLOAD4,2,2,1.,2.,3.,4.,15,17\n,4,1.,0.,0.\nPLOAD4,2,4,1.,,,,21,23\n"
)
CONTACT = (
    "SET1,3,1,THRU,5,EXCEPT,2\nBSURFS,5,,,,1,5,6,7\nBSURFS,6,,,,2,11,13,12\n"
    "BCTSET,4,5,6,0.,-1.,2.\nBCTADD,8,4\nBCTPARM,4,PENN,10.,PENT,1.\nBCRPARA,5,TOP,0.,FLEX\n"
    "BGSET,11,5,6,.5\nBGADD,12,11\nBGPARM,12,PENN,10.\n"
    "BCPROP,31,1\nBSURF,32,2\nBCBODY1,7,,3D,DEFORM,31\nBCBODY,8,3D,DEFORM,32,,0.\n"
    "BCTABL1,9,33\nBCONECT,33,1,2,7,8\nBCONPRG,1,,ICOORD,0,IGLUE,0\nBCONPRP,2,,FRIC,0.\n"
    "BCPARA,0,ERROR,.1\n"
    "BCTABLE,10,,,1\n,SECNDRY,7,,,0.,0.,0\n,,,0\n,PRIMARY,8\n"
    "BOLT,1,1,71\nBOLTFOR,3,5000.,1\nBOLTLD,9,2.,1.,3\nPARAM,WTMASS,2.\n"
)
BULK = SOLIDS + LINES + STRUCTURE + BARS + TIES + LOADS + CONTACT
# Elements that can be built, whose masses loads act on.
HEAVY = (
    SOLIDS + LINES + "CORD2R,4,0,0.,0.,0.,1.,0.,0.\n,0.,1.,0.\n"
    "SPC,5,94,3,.1,92,2,.2\nSPC1,5,12,91,94\nSPCD,1,94,1,.3,91,12,.4\n"
    "GRAV,2,4,9.,.1,.2,-1.\nRFORCE,1,94,4,2.,0.,0.,1.,1\n,0.\nLOAD,10,2.,1.5,1,.5,2\n"
)
SUBCASES = (1, 2, 3, 4)
