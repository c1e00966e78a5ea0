"""As much of CasADi as an exported bank uses, where the real one is absent: expressions that are worked out by numpy
when a Function is called. Shapes are checked as CasADi checks them: they agree, or one side is a scalar."""
import numpy as np


def _wrap(value):
    return value if isinstance(value, Expression) else Expression(np.shape(np.atleast_2d(value)), lambda _: np.atleast_2d(np.asarray(value, float)))


class Expression:
    def __init__(self, shape, evaluate):
        self.shape = tuple(int(n) for n in shape)
        self.evaluate = evaluate

    def at(self, values):
        result = np.asarray(self.evaluate(values), float)
        assert result.shape == self.shape, (result.shape, self.shape)
        return result

    def _with(self, other, operation):
        other = _wrap(other)
        scalar = (1, 1)
        assert self.shape == other.shape or scalar in (self.shape, other.shape), (self.shape, other.shape)
        return Expression(self.shape if other.shape == scalar else other.shape, lambda v: operation(self.at(v), other.at(v)))

    def __add__(self, other): return self._with(other, np.add)
    def __radd__(self, other): return _wrap(other)._with(self, np.add)
    def __sub__(self, other): return self._with(other, np.subtract)
    def __rsub__(self, other): return _wrap(other)._with(self, np.subtract)
    def __mul__(self, other): return self._with(other, np.multiply)
    def __rmul__(self, other): return _wrap(other)._with(self, np.multiply)
    def __truediv__(self, other): return self._with(other, np.divide)
    def __neg__(self): return Expression(self.shape, lambda v: -self.at(v))

    @property
    def T(self):
        return Expression(self.shape[::-1], lambda v: self.at(v).T)

    def __getitem__(self, key):
        if not isinstance(key, tuple):
            assert self.shape[1] == 1
            key = (key, 0)
        rows, columns = (slice(k, k + 1) if isinstance(k, int) else k for k in key)
        return Expression(np.empty(self.shape)[rows, columns].shape, lambda v: self.at(v)[rows, columns])


class DM(Expression):
    def __init__(self, rows):
        array = np.array(rows, float)
        array = array.reshape(-1, 1) if array.ndim == 1 else array
        super().__init__(array.shape, lambda _: array)

    @staticmethod
    def zeros(rows, columns):
        return Expression((rows, columns), lambda _: np.zeros((rows, columns)))


class SX:
    @staticmethod
    def sym(name, rows):
        return Expression((rows, 1), lambda values: values[name])


class Function:
    def __init__(self, name, inputs, outputs, input_names, output_names):
        assert len(inputs) == len(input_names) and len(outputs) == len(output_names)
        self.outputs, self.names = outputs, input_names

    def __call__(self, *arguments):
        values = {name: np.asarray(a, float).reshape(-1, 1) for name, a in zip(self.names, arguments, strict=True)}
        return [output.at(values) for output in self.outputs]


def mtimes(a, b):
    a, b = _wrap(a), _wrap(b)
    assert a.shape[1] == b.shape[0], (a.shape, b.shape)
    return Expression((a.shape[0], b.shape[1]), lambda v: a.at(v) @ b.at(v))


def vertcat(*parts):
    return Expression((sum(p.shape[0] for p in parts), 1), lambda v: np.vstack([p.at(v) for p in parts]))


def repmat(a, rows, columns):
    return Expression((a.shape[0] * rows, a.shape[1] * columns), lambda v: np.tile(a.at(v), (rows, columns)))


def exp(a): return Expression(a.shape, lambda v: np.exp(a.at(v)))
def fmax(a, b): return _wrap(a)._with(b, np.maximum)
def mmax(a): return Expression((1, 1), lambda v: np.max(a.at(v)).reshape(1, 1))
def sum2(a): return Expression((a.shape[0], 1), lambda v: a.at(v).sum(axis=1, keepdims=True))
